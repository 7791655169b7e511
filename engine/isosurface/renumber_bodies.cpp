#include "engine/isosurface/renumber_bodies.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

namespace geosis {
namespace {

std::array<std::int64_t, 3> lattice_steps(Vec3f p) {
  const auto steps = [](float x) { return static_cast<std::int64_t>(x * float{kLatticeStepsPerVoxel}); };
  return {steps(p.x), steps(p.y), steps(p.z)};
}

/// Enclosed volumes, exact, as lattice_volumes (brick_bodies.h) has them.
std::vector<double> enclosed_volumes(const LabelledSurface& surface, bool mirrored) {
  std::vector<std::uint64_t> six_volumes(surface.samples.size(), 0);
  for (const auto& [p, q, r] : surface.mesh.triangles) {
    const auto a = lattice_steps(surface.mesh.positions[p]), b = lattice_steps(surface.mesh.positions[q]),
               c = lattice_steps(surface.mesh.positions[r]);
    const std::int64_t twice_area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    six_volumes[surface.body[p]] += static_cast<std::uint64_t>((a[2] + b[2] + c[2]) * twice_area);
  }
  constexpr double kSixCubes = 6.0 * kLatticeStepsPerVoxel * kLatticeStepsPerVoxel * kLatticeStepsPerVoxel;
  std::vector<double> volumes;
  for (const std::uint64_t six : six_volumes) {
    volumes.push_back(static_cast<double>(std::bit_cast<std::int64_t>(mirrored ? -six : six)) / kSixCubes);
  }
  return volumes;
}

/// Old numbers of the bodies, in the order of the new ones.
std::vector<std::uint32_t> order_bodies(const LabelledSurface& surface) {
  std::vector<std::size_t> lowest(surface.samples.size(), std::numeric_limits<std::size_t>::max());
  for (std::size_t v = surface.body.size(); v-- > 0;) lowest[surface.body[v]] = v;
  std::vector<std::uint32_t> order(surface.samples.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (surface.volume_voxels[a] != surface.volume_voxels[b]) {
      return surface.volume_voxels[a] > surface.volume_voxels[b];
    }
    return lowest[a] != lowest[b] ? lowest[a] < lowest[b] : a < b;
  });
  return order;
}

}  // namespace

void renumber_bodies(LabelledSurface& surface, bool capped, bool mirrored) {
  if (surface.samples.empty()) return;
  if (capped) surface.volume_voxels = enclosed_volumes(surface, mirrored);
  const std::vector<std::uint32_t> order = order_bodies(surface);
  std::vector<std::uint32_t> number(order.size());
  std::vector<BodySamples> samples;
  std::vector<double> volumes;
  for (const std::uint32_t body : order) {
    number[body] = static_cast<std::uint32_t>(samples.size());
    samples.push_back(surface.samples[body]);
    volumes.push_back(surface.volume_voxels[body]);
  }
  surface.samples = std::move(samples);
  surface.volume_voxels = std::move(volumes);
  for (std::uint32_t& body : surface.body) body = number[body];
  for (auto& body : surface.seed_body) {
    if (body) body = number[*body];
  }
}

}  // namespace geosis
