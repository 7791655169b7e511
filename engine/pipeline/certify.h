#pragma once

#include <optional>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/mesh/indexed_mesh.h"
#include "engine/pipeline/reconstruct.h"
#include "engine/volume/geometry.h"

namespace geosis {

/// What certificates are measured in.
struct CertifyOptions {
  const AffineGeometry& space;  ///< from index coordinates to the requested space
  bool has_lengths = true;      ///< its axes have one unit
  int threads = 1;
};

/// Topology, area and volume of a level as it decodes.
void describe_level(const IndexedMesh& decoded, const CertifyOptions& options, ReconstructedLevel& level);

/// Distance and volume drift of every level, given what each decodes to: none for M0 itself, the same for levels that
/// are equal.
///
/// errors   cancelled.
Result<void> compare_with_m0(std::vector<ReconstructedLevel>& levels, const std::vector<IndexedMesh>& decoded,
                             const IndexedMesh& m0, const CertifyOptions& options, Progress& progress);

}  // namespace geosis
