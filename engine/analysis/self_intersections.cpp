#include "engine/analysis/self_intersections.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "engine/base/parallel.h"
#include "engine/mesh/lattice_triangles.h"

namespace geosis {
namespace {

using Pair = std::array<std::int32_t, 2>;

/// Bounding box in lattice steps, both ends included.
struct Box {
  std::array<std::int32_t, 3> low{}, high{};

  bool meets(const Box& other) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (low[axis] > other.high[axis] || other.low[axis] > high[axis]) return false;
    }
    return true;
  }
};

LatticePoint lattice_point(Vec3f p) {
  LatticePoint steps;
  for (int axis = 0; axis < 3; ++axis) {
    steps[axis] = static_cast<std::int64_t>(static_cast<double>(p[axis]) * kLatticeStepsPerVoxel);
  }
  return steps;
}

LatticeTriangle lattice_triangle(const IndexedMesh& mesh, std::int32_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  return {lattice_point(mesh.positions[a]), lattice_point(mesh.positions[b]), lattice_point(mesh.positions[c])};
}

std::vector<Box> boxes_of(const IndexedMesh& mesh) {
  std::vector<Box> boxes(mesh.triangles.size());
  for (std::size_t t = 0; t < boxes.size(); ++t) {
    const auto [a, b, c] = lattice_triangle(mesh, static_cast<std::int32_t>(t));
    for (int axis = 0; axis < 3; ++axis) {
      const auto [low, high] = std::minmax({a[axis], b[axis], c[axis]});
      boxes[t].low[axis] = static_cast<std::int32_t>(low);
      boxes[t].high[axis] = static_cast<std::int32_t>(high);
    }
  }
  return boxes;
}

/// Triangles by the cubic cells that their boxes touch.
class BoxGrid {
 public:
  explicit BoxGrid(const std::vector<Box>& boxes) : boxes_(boxes) {
    low_.fill(std::numeric_limits<std::int32_t>::max());
    high_.fill(std::numeric_limits<std::int32_t>::min());
    for (const Box& box : boxes) {
      for (int axis = 0; axis < 3; ++axis) {
        low_[axis] = std::min(low_[axis], box.low[axis]);
        high_[axis] = std::max(high_[axis], box.high[axis]);
      }
    }
    choose_cell_size();
    fill();
  }

  std::size_t cells() const { return first_.size() - 1; }

  /// Calls visit(a, b), a < b, for the pairs whose boxes meet and have their lowest common point in this cell: every
  /// such pair is met in exactly one cell.
  template <class Visit>
  void each_pair(std::size_t cell, const Visit& visit) const {
    for (std::uint32_t m = first_[cell]; m < first_[cell + 1]; ++m) {
      for (std::uint32_t n = m + 1; n < first_[cell + 1]; ++n) {
        const std::int32_t a = triangles_[m], b = triangles_[n];
        if (boxes_[a].meets(boxes_[b]) && lowest_common_cell(boxes_[a], boxes_[b]) == cell) visit(a, b);
      }
    }
  }

 private:
  /// A voxel, as wide as a triangle of the finest level; not many more cells than triangles; wider while long triangles
  /// fill the lists.
  void choose_cell_size() {
    const auto triangles = static_cast<double>(boxes_.size());
    cell_ = kLatticeStepsPerVoxel;
    while (cells_between(low_, high_) > 2 * triangles + kFreeCells || entries() > 16 * (triangles + kFreeCells)) {
      cell_ *= 2;
    }
    for (int axis = 0; axis < 3; ++axis) shape_[axis] = along(axis, high_[axis]) + 1;
  }

  double cells_between(const std::array<std::int32_t, 3>& low, const std::array<std::int32_t, 3>& high) const {
    double count = 1;
    for (int axis = 0; axis < 3; ++axis) {
      count *= static_cast<double>(along(axis, high[axis]) - along(axis, low[axis]) + 1);
    }
    return count;
  }
  double entries() const {
    double count = 0;
    for (const Box& box : boxes_) count += cells_between(box.low, box.high);
    return count;
  }

  std::int64_t along(int axis, std::int32_t steps) const { return (std::int64_t{steps} - low_[axis]) / cell_; }
  std::size_t number_of(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return static_cast<std::size_t>((i * shape_[1] + j) * shape_[2] + k);
  }
  std::size_t lowest_common_cell(const Box& a, const Box& b) const {
    std::array<std::int64_t, 3> at{};
    for (int axis = 0; axis < 3; ++axis) at[axis] = along(axis, std::max(a.low[axis], b.low[axis]));
    return number_of(at[0], at[1], at[2]);
  }

  template <class Visit>
  void each_cell(const Box& box, const Visit& visit) const {
    for (std::int64_t i = along(0, box.low[0]); i <= along(0, box.high[0]); ++i) {
      for (std::int64_t j = along(1, box.low[1]); j <= along(1, box.high[1]); ++j) {
        for (std::int64_t k = along(2, box.low[2]); k <= along(2, box.high[2]); ++k) visit(number_of(i, j, k));
      }
    }
  }

  /// Counts become ends; filling from the last triangle on turns each end into a start.
  void fill() {
    first_.assign(static_cast<std::size_t>(shape_[0] * shape_[1] * shape_[2]) + 1, 0);
    for (const Box& box : boxes_) each_cell(box, [&](std::size_t cell) { ++first_[cell]; });
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    triangles_.resize(first_.back());
    for (std::size_t t = boxes_.size(); t-- > 0;) {
      each_cell(boxes_[t], [&](std::size_t cell) { triangles_[--first_[cell]] = static_cast<std::int32_t>(t); });
    }
  }

  static constexpr double kFreeCells = 2'000;

  const std::vector<Box>& boxes_;
  std::array<std::int32_t, 3> low_{}, high_{};  ///< of all boxes
  std::int64_t cell_ = 1;                       ///< width of a cell
  std::array<std::int64_t, 3> shape_{};
  std::vector<std::uint32_t> first_;     ///< (cells + 1) where each cell's triangles start
  std::vector<std::int32_t> triangles_;  ///< ascending in each cell
};

/// The pairs found by each task: the cells are dealt out in runs.
std::vector<std::vector<Pair>> pairs_by_run(const IndexedMesh& mesh, int threads) {
  constexpr std::size_t kRuns = 256;
  std::vector<std::vector<Pair>> found(kRuns);
  if (mesh.triangles.empty()) return found;
  const std::vector<Box> boxes = boxes_of(mesh);
  const BoxGrid grid(boxes);
  parallel_for(kRuns, threads, [&](std::size_t run) {
    for (std::size_t cell = grid.cells() * run / kRuns; cell < grid.cells() * (run + 1) / kRuns; ++cell) {
      grid.each_pair(cell, [&](std::int32_t a, std::int32_t b) {
        if (triangles_intersect(lattice_triangle(mesh, a), lattice_triangle(mesh, b))) found[run].push_back({a, b});
      });
    }
  });
  return found;
}

}  // namespace

std::vector<std::array<std::int32_t, 2>> find_intersecting_pairs(const IndexedMesh& mesh, int threads) {
  std::vector<Pair> pairs;
  for (const auto& run : pairs_by_run(mesh, threads)) pairs.insert(pairs.end(), run.begin(), run.end());
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::int64_t count_intersecting_pairs(const IndexedMesh& mesh, int threads) {
  std::int64_t count = 0;
  for (const auto& run : pairs_by_run(mesh, threads)) count += static_cast<std::int64_t>(run.size());
  return count;
}

}  // namespace geosis
