#pragma once

#include <cstdint>

#include "engine/pipeline/reconstruct.h"
#include "engine/volume/bricks.h"

namespace geosis {

/// What a reconstruction would take and give, about.
struct ReconstructEstimate {
  std::uint64_t triangles = 0;     ///< of M0
  std::uint64_t bytes = 0;         ///< of all levels, encoded
  std::uint64_t memory_bytes = 0;  ///< at the peak, without mapped files
  double processor_seconds = 0;    ///< of all threads together
  double seconds = 0;              ///< with options.threads that nobody else uses
};

/// From the volume's index alone: no sample is read. docs/estimates.md says how near it comes. Bodies that the request
/// leaves out, and levels by distance or cost, are counted as if everything were kept; a structural grid, as if it were
/// not there yet and had the surface of the axis grid.
ReconstructEstimate estimate_reconstruction(const BrickedVolume& samples, const ReconstructOptions& options);

/// Memory that importing a file takes at the peak, whatever its size. docs/estimates.md.
inline constexpr std::uint64_t kImportMemoryBytes = std::uint64_t{64} << 20;

}  // namespace geosis
