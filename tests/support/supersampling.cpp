#include "tests/support/supersampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/support/union_find.h"

namespace geosis::test {
namespace {

// Voxels of the body, with a layer of empty ones all around.
class VoxelBody {
 public:
  VoxelBody(const ScalarField& field, IsoRange range, BodyMode mode, int refinement)
      : shape_{(field.shape.inlines - 1) * refinement + 2, (field.shape.crosslines - 1) * refinement + 2,
               (field.shape.samples - 1) * refinement + 2},
        inside_(static_cast<std::size_t>(shape_.count())) {
    for_each_node({field.shape.inlines - 1, field.shape.crosslines - 1, field.shape.samples - 1},
                  [&](GridIndex cell) { fill_cell(field, range, mode, refinement, cell); });
  }

  std::int64_t voxels() const { return std::count(inside_.begin(), inside_.end(), 1); }

  // Of the interior of the voxels' union: a shared face, edge or corner is inside when all voxels around it are.
  std::int64_t open_euler() const {
    std::int64_t euler = 0;
    for_each_voxel([&](std::int32_t v) {
      for (int axes = 0; axes < 8; ++axes) {
        bool all = true;
        for (int step = 0; step < 8; ++step)
          if ((step & axes) == step) all = all && inside_[v - offset(step)];
        const int shared = (axes >> 2 & 1) + (axes >> 1 & 1) + (axes & 1);
        if (all) euler += shared % 2 == 0 ? -1 : 1;
      }
    });
    return euler;
  }

  std::int64_t surface_components() const {
    UnionFind sets(shape_.count());
    for (std::int32_t v = 0; v < shape_.count(); ++v)
      if (on_rim(v)) sets.unite(v, 0);
    for_each_voxel([&](std::int32_t v) {
      for (const int axis : {1, 2, 4}) {
        join(sets, v, v - offset(axis), true);
        join(sets, v, v + offset(axis), true);
      }
      for (int step = 3; step < 8; ++step) {
        join(sets, v, v - offset(step), false);
        // The other diagonals of the faces and of the cube: some axes forward, some back.
        for (int forward = 1; forward < step; ++forward)
          if ((forward & step) == forward) join(sets, v, v - offset(step & ~forward) + offset(forward), false);
      }
    });
    return sets.count() - 1;
  }

 private:
  void fill_cell(const ScalarField& field, IsoRange range, BodyMode mode, int refinement, GridIndex cell) {
    std::array<double, 8> corner;
    for (int c = 0; c < 8; ++c) {
      const float f = field.at({cell.i + (c >> 2), cell.j + (c >> 1 & 1), cell.k + (c & 1)});
      if (std::isnan(f)) return;
      corner[c] = mode == BodyMode::exact ? f : product(f, range);
    }
    const double low = mode == BodyMode::exact ? range.low : 0, high = mode == BodyMode::exact ? range.high : INFINITY;
    for_each_node({refinement, refinement, refinement}, [&](GridIndex v) {
      const double x = (v.i + 0.5) / refinement, y = (v.j + 0.5) / refinement, z = (v.k + 0.5) / refinement;
      const auto mix = [](double a, double b, double t) { return a * (1 - t) + b * t; };
      const double f = mix(mix(mix(corner[0], corner[1], z), mix(corner[2], corner[3], z), y),
                           mix(mix(corner[4], corner[5], z), mix(corner[6], corner[7], z), y), x);
      if (low <= f && f <= high)
        inside_[index({cell.i * refinement + v.i + 1, cell.j * refinement + v.j + 1, cell.k * refinement + v.k + 1})] =
            1;
    });
  }

  static double product(float f, IsoRange range) {
    double g = 1;
    if (!std::isinf(range.low)) g *= static_cast<double>(f) - range.low;
    if (!std::isinf(range.high)) g *= static_cast<double>(range.high) - f;
    return g;
  }

  std::int32_t index(GridIndex v) const { return (v.i * shape_.crosslines + v.j) * shape_.samples + v.k; }
  std::int32_t offset(int step) const { return index({step >> 2 & 1, step >> 1 & 1, step & 1}); }
  bool on_rim(std::int32_t v) const {
    const std::int32_t k = v % shape_.samples, j = v / shape_.samples % shape_.crosslines,
                       i = v / shape_.samples / shape_.crosslines;
    return i == 0 || j == 0 || k == 0 || i == shape_.inlines - 1 || j == shape_.crosslines - 1 ||
           k == shape_.samples - 1;
  }
  template <class Visit>
  void for_each_voxel(Visit&& visit) const {
    for (std::int32_t v = 0; v < shape_.count(); ++v)
      if (!on_rim(v)) visit(v);
  }
  void join(UnionFind& sets, std::int32_t a, std::int32_t b, bool share_a_face) const {
    if (inside_[a] != inside_[b]) return;
    if (share_a_face || inside_[a] == 0) sets.unite(a, b);
  }

  GridShape shape_;
  std::vector<std::uint8_t> inside_;
};

}  // namespace

SurfaceTopology supersampled_surface(const ScalarField& field, IsoRange range, BodyMode mode, int refinement) {
  const VoxelBody body(field, range, mode, refinement);
  return {true, -2 * body.open_euler(), body.surface_components()};
}

double supersampled_volume(const ScalarField& field, IsoRange range, BodyMode mode, int refinement) {
  return static_cast<double>(VoxelBody(field, range, mode, refinement).voxels()) /
         (static_cast<double>(refinement) * refinement * refinement);
}

}  // namespace geosis::test
