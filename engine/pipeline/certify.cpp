#include "engine/pipeline/certify.h"

#include <cmath>
#include <utility>

namespace geosis {
namespace {

bool same_mesh(const IndexedMesh& a, const IndexedMesh& b) {
  return a.positions == b.positions && a.triangles == b.triangles;
}

/// The mesh mapped to the space, relative to where the space puts `origin`: float32 is enough for a body, not for a
/// place on earth.
IndexedMesh mapped(const IndexedMesh& mesh, const AffineGeometry& space, Vec3d origin) {
  IndexedMesh result{{}, mesh.triangles};
  result.positions.reserve(mesh.positions.size());
  for (const Vec3f& p : mesh.positions) {
    const Vec3d q = space.map(to_double(p)) - origin;
    result.positions.push_back({static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z)});
  }
  return result;
}

/// Distances to M0 in voxels and in the units of the space. Both need M0 prepared: once for all levels.
class DistanceToM0 {
 public:
  DistanceToM0(const IndexedMesh& m0, const CertifyOptions& options)
      : options_(options), by_index_(m0, {.threads = options.threads}) {
    if (!options.has_lengths || is_index_space()) return;
    origin_ = options.space.map(to_double(m0.positions.front()));
    m0_in_space_ = mapped(m0, options.space, origin_);
    in_space_.emplace(m0_in_space_, DistanceOptions{.threads = options.threads});
  }
  DistanceToM0(const DistanceToM0&) = delete;
  DistanceToM0& operator=(const DistanceToM0&) = delete;

  void measure(const IndexedMesh& decoded, ReconstructedLevel& level) const {
    level.distance = by_index_.measure(decoded);
    if (in_space_) {
      const SurfaceDistance distance = in_space_->measure(mapped(decoded, options_.space, origin_));
      level.space_distance = SpaceDistance{distance.mean_voxels, distance.max_voxels};
    } else if (options_.has_lengths) {
      level.space_distance = SpaceDistance{level.distance.mean_voxels, level.distance.max_voxels};
    }
  }

 private:
  bool is_index_space() const { return *options_.space.affine() == *AffineGeometry().affine(); }

  const CertifyOptions& options_;
  ReferenceSurface by_index_;
  Vec3d origin_;
  IndexedMesh m0_in_space_;
  std::optional<ReferenceSurface> in_space_;
};

}  // namespace

void describe_level(const IndexedMesh& decoded, const CertifyOptions& options, ReconstructedLevel& level) {
  level.topology = report_topology(decoded);
  level.measures = measure_surface(decoded, options.space);
}

Result<void> compare_with_m0(std::vector<ReconstructedLevel>& levels, const std::vector<IndexedMesh>& decoded,
                             const IndexedMesh& m0, const CertifyOptions& options, Progress& progress) {
  const double m0_volume = measure_surface(m0, options.space).volume;
  std::optional<DistanceToM0> distance;
  for (std::size_t k = levels.size(); k-- > 0;) {
    if (progress.cancelled()) return Error{ErrorCode::cancelled, "certifying the levels was cancelled"};
    progress.report("certify", 1 - static_cast<double>(k + 1) / static_cast<double>(levels.size()));
    ReconstructedLevel& level = levels[k];
    if (same_mesh(level.lod.mesh, m0)) {
      if (options.has_lengths) level.space_distance = SpaceDistance{};
      continue;
    }
    if (m0_volume != 0) level.volume_drift = (level.measures.volume - m0_volume) / m0_volume;
    if (k + 1 < levels.size() && same_mesh(level.lod.mesh, levels[k + 1].lod.mesh)) {
      level.distance = levels[k + 1].distance;
      level.space_distance = levels[k + 1].space_distance;
      continue;
    }
    if (!distance) distance.emplace(m0, options);
    distance->measure(decoded[k], level);
  }
  progress.report("certify", 1);
  return {};
}

}  // namespace geosis
