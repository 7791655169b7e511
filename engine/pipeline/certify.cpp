#include "engine/pipeline/certify.h"

#include <functional>
#include <utility>

namespace geosis {
namespace {

bool same_mesh(const IndexedMesh& a, const IndexedMesh& b) {
  return a.positions == b.positions && a.triangles == b.triangles;
}

/// The mesh mapped to the space, relative to where the space puts the origin.
IndexedMesh mapped(const IndexedMesh& mesh, const AffineGeometry& space, Vec3d origin) {
  IndexedMesh result{{}, mesh.triangles};
  result.positions.reserve(mesh.positions.size());
  for (const Vec3f& p : mesh.positions) {
    const Vec3d q = space.map(to_double(p)) - origin;
    result.positions.push_back({static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z)});
  }
  return result;
}

/// For each level the one that is measured in its place: itself, or the coarsest one that is equal to it.
std::vector<std::size_t> equal_levels(const std::vector<ReconstructedLevel>& levels) {
  std::vector<std::size_t> equal(levels.size());
  for (std::size_t k = levels.size(); k-- > 0;) {
    const bool as_next = k + 1 < levels.size() && same_mesh(levels[k].lod.mesh, levels[k + 1].lod.mesh);
    equal[k] = as_next ? equal[k + 1] : k;
  }
  return equal;
}

}  // namespace

Result<void> describe_level(const IndexedMesh& decoded, const CertifyOptions& options, const Progress& progress,
                            ReconstructedLevel& level) {
  const auto topology = report_topology(decoded, progress);
  if (!topology) return topology.error();
  const auto measures = measure_surface(decoded, options.space, progress);
  if (!measures) return measures.error();
  level.topology = *topology;
  level.measures = *measures;
  return {};
}

/// Whether distances in the space differ from those in voxels.
bool LevelComparison::is_mapped() const {
  return options_.has_lengths && *options_.space.affine() != *AffineGeometry().affine();
}

void LevelComparison::prepare(TaskBoard& board) {
  board.add(kComparisonUrgency,
            [this] { by_index_.emplace(m0_, DistanceOptions{.threads = options_.threads}, progress_); });
  if (is_mapped()) board.add(kComparisonUrgency, [this] { prepare_in_space(); });
  board.add(kComparisonUrgency, [this] {
    const auto measures = measure_surface(m0_, options_.space, progress_);
    if (measures) volume_ = measures->volume;
  });
}

void LevelComparison::prepare_in_space() {
  origin_ = options_.space.map(to_double(m0_.positions.front()));
  m0_in_space_ = mapped(m0_, options_.space, origin_);
  in_space_.emplace(m0_in_space_, DistanceOptions{.threads = options_.threads}, progress_);
}

void LevelComparison::measure(const IndexedMesh& decoded, ReconstructedLevel& level) const {
  if (const auto distance = by_index_->measure(decoded, progress_)) level.distance = *distance;
}

void LevelComparison::measure_in_space(const IndexedMesh& decoded, ReconstructedLevel& level) const {
  const auto distance = in_space_->measure(mapped(decoded, options_.space, origin_), progress_);
  if (distance) level.space_distance = SpaceDistance{distance->mean_voxels, distance->max_voxels};
}

Result<void> LevelComparison::compare(std::vector<ReconstructedLevel>& levels,
                                      const std::vector<const IndexedMesh*>& decoded, TaskBoard& board) {
  const auto never = [] { return false; };
  progress_.report("certify", 0);
  const std::vector<std::size_t> equal = equal_levels(levels);
  board.work_until(kComparisonUrgency, never);  // M0 is prepared
  std::vector<std::size_t> measured;
  for (std::size_t k = levels.size(); k-- > 0;) {
    if (same_mesh(levels[k].lod.mesh, m0_)) continue;
    if (volume_ != 0) levels[k].volume_drift = (levels[k].measures.volume - volume_) / volume_;
    if (equal[k] == k) measured.push_back(k);
  }
  const std::size_t tasks = measured.size() * (is_mapped() ? 2 : 1);
  const auto add = [&](const std::function<void()>& measure) {
    board.add(kComparisonUrgency, [this, measure] {
      if (!progress_.cancelled()) measure();
      ++ended_;
    });
  };
  for (const std::size_t k : measured) {
    const IndexedMesh& mesh = *decoded[k];
    ReconstructedLevel& level = levels[k];
    add([this, &mesh, &level] { measure(mesh, level); });
    if (is_mapped()) add([this, &mesh, &level] { measure_in_space(mesh, level); });
  }
  board.work_until(kComparisonUrgency, [&] {
    progress_.report("certify", tasks == 0 ? 1 : static_cast<double>(ended_) / static_cast<double>(tasks));
    return ended_ == tasks;
  });
  if (progress_.cancelled()) return Error{ErrorCode::cancelled, "certifying the levels was cancelled"};
  for (std::size_t k = levels.size(); k-- > 0;) {
    levels[k].distance = levels[equal[k]].distance;
    levels[k].space_distance = levels[equal[k]].space_distance;
    if (options_.has_lengths && !levels[k].space_distance) {
      levels[k].space_distance = SpaceDistance{levels[k].distance.mean_voxels, levels[k].distance.max_voxels};
    }
  }
  return {};
}

}  // namespace geosis
