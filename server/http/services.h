#pragma once

#include <string>

#include "server/app/extractions.h"
#include "server/app/volumes.h"
#include "server/http/waiting_room.h"
#include "server/jobs/job_queue.h"
#include "server/store/blob_store.h"

namespace geosis::server::http {

/// The use cases that the routes open to HTTP. Outlives the front.
struct Services {
  BlobStore& store;
  Volumes& volumes;
  Extractions& extractions;
  JobQueue& queue;
  WaitingRoom& waiting;
};

/// Runs work that computes on a worker and waits for it: no handler thread computes itself.
///
/// errors   those of the work; unavailable: the queue or the waiting room is full.
Result<void> run_on_worker(Services services, const JobQueue::Work& work);

}  // namespace geosis::server::http
