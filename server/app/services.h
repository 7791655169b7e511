#pragma once

#include "engine/pipeline/estimate.h"
#include "server/app/extractions/extractions.h"
#include "server/app/volumes/volumes.h"
#include "server/jobs/job_queue.h"
#include "server/jobs/memory_budget.h"
#include "server/store/blob_store.h"

namespace geosis::server {

/// The use cases of one tenant, as the doors call them. Outlives the doors.
struct Services {
  BlobStore& store;
  Volumes& volumes;
  Extractions& extractions;
  JobQueue& queue;
  MemoryBudget& memory;
};

/// Memory for one import. errors: unavailable: others have taken it.
inline Result<MemoryBudget::Reservation> memory_to_import(const Services& services) {
  auto reserved = services.memory.reserve(kImportMemoryBytes);
  if (!reserved) return Error{ErrorCode::unavailable, "the server's memory is taken by what runs already"};
  return *std::move(reserved);
}

}  // namespace geosis::server
