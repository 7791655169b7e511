#include "engine/simplify/check_m0.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "engine/mesh/check.h"
#include "engine/mesh/corner_table.h"

namespace geosis {
namespace {

constexpr float kLargestCoordinate = 131'072;  // voxels; beyond, float32 does not hold all lattice points

bool on_lattice(float x) {
  const bool in_range = std::abs(x) <= kLargestCoordinate;  // false for NaN
  const float steps = in_range ? x * kLatticeStepsPerVoxel : 0.5f;
  return steps == static_cast<float>(static_cast<std::int32_t>(steps));
}

Result<void> check_positions(const std::vector<Vec3f>& positions) {
  for (std::size_t v = 0; v < positions.size(); ++v) {
    for (int axis = 0; axis < 3; ++axis) {
      if (on_lattice(positions[v][axis])) continue;
      return Error{ErrorCode::invalid_argument, "vertex " + std::to_string(v) + ": coordinate " +
                                                    std::to_string(positions[v][axis]) +
                                                    "; expected a multiple of 1/64 within 131072 of zero"};
    }
  }
  return {};
}

bool indices_in_range(const IndexedMesh& mesh) {
  const auto vertices = static_cast<std::uint32_t>(mesh.positions.size());
  bool in_range = mesh.positions.size() <= std::numeric_limits<std::int32_t>::max();
  for (const auto& [a, b, c] : mesh.triangles) {
    in_range &= (static_cast<std::uint32_t>(a) < vertices) & (static_cast<std::uint32_t>(b) < vertices) &
                (static_cast<std::uint32_t>(c) < vertices);
  }
  return in_range;
}

}  // namespace

Result<void> check_m0(const IndexedMesh& m0) {
  if (auto lattice = check_positions(m0.positions); !lattice) return lattice;
  if (!indices_in_range(m0)) return fault_of(m0);
  return {};
}

Error fault_of(const IndexedMesh& m0) {
  const auto table = build_corner_table(m0);
  if (!table) return table.error();
  if (auto fans = check_fans(*table, m0.positions.size()); !fans) return std::move(fans).error();
  return {ErrorCode::internal, "levels of detail: a manifold was taken for something else"};
}

}  // namespace geosis
