#pragma once

#include <atomic>
#include <cstddef>
#include <optional>
#include <vector>

#include "engine/analysis/surface_distance.h"
#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/base/task_board.h"
#include "engine/base/vec3.h"
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

/// Topology, area and volume of a level as it decodes. errors: cancelled.
Result<void> describe_level(const IndexedMesh& decoded, const CertifyOptions& options, const Progress& progress,
                            ReconstructedLevel& level);

/// Of tasks that compare with M0: whatever makes or describes a level goes before.
inline constexpr int kComparisonUrgency = -1;

/// Distance and volume drift of levels against M0, by tasks on a board that must be gone before this and the levels
/// are.
class LevelComparison {
 public:
  /// m0 and progress are kept by reference.
  LevelComparison(const IndexedMesh& m0, const CertifyOptions& options, Progress& progress)
      : m0_(m0), options_(options), progress_(progress) {}
  LevelComparison(const LevelComparison&) = delete;
  LevelComparison& operator=(const LevelComparison&) = delete;

  /// Adds the tasks that prepare M0, which wait for no level. Needed when a level is another mesh.
  void prepare(TaskBoard& board);

  /// Fills in every level, given what each decodes to: no distance for M0 itself, the same for levels that are equal.
  ///
  /// errors   cancelled.
  Result<void> compare(std::vector<ReconstructedLevel>& levels, const std::vector<const IndexedMesh*>& decoded,
                       TaskBoard& board);

 private:
  bool is_mapped() const;
  void prepare_in_space();
  // Nothing is filled in when it is cancelled.
  void measure(const IndexedMesh& decoded, ReconstructedLevel& level) const;
  void measure_in_space(const IndexedMesh& decoded, ReconstructedLevel& level) const;

  const IndexedMesh& m0_;
  const CertifyOptions options_;
  Progress& progress_;
  std::optional<ReferenceSurface> by_index_, in_space_;
  IndexedMesh m0_in_space_;
  Vec3d origin_;  ///< what meshes in the space are relative to: float32 is enough for a body, not for a place on earth
  double volume_ = 0;
  std::atomic<std::size_t> ended_ = 0;  ///< distances that are measured
};

}  // namespace geosis
