#pragma once

#include "engine/pipeline/estimate.h"
#include "server/app/volumes/volumes.h"
#include "server/documents/json_text.h"

namespace geosis::server {

/// Memory to reserve for a computation whose estimate is this: estimates may be too low.
inline std::uint64_t memory_to_reserve(const ReconstructEstimate& estimate) {
  return estimate.memory_bytes + estimate.memory_bytes / 2;
}

/// {"triangles", "bytes", "memory_bytes", "seconds"}: what a dry run answers.
inline Json estimate_document(const ReconstructEstimate& estimate) {
  return {{"triangles", estimate.triangles},
          {"bytes", estimate.bytes},
          {"memory_bytes", estimate.memory_bytes},
          {"seconds", estimate.seconds}};
}

}  // namespace geosis::server
