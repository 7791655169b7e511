#pragma once

#include "server/app/extractions.h"
#include "server/app/volumes.h"
#include "server/jobs/job_queue.h"
#include "server/store/blob_store.h"

namespace geosis::server::http {

/// The use cases that the routes open to HTTP. Outlives the front.
struct Services {
  BlobStore& store;
  Volumes& volumes;
  Extractions& extractions;
  JobQueue& queue;
};

}  // namespace geosis::server::http
