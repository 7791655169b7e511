#include "engine/analysis/triangle_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "engine/analysis/triangle_distance.h"
#include "engine/base/stretches.h"

namespace geosis {
namespace {

/// Cells that cost nothing beside thousands of searches, however few the triangles are: coarse levels have triangles of
/// very different sizes.
constexpr double kFreeCells = 2'000;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <class T>
Vec3<T> lower(Vec3<T> a, Vec3<T> b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}

template <class T>
Vec3<T> upper(Vec3<T> a, Vec3<T> b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

struct Corners {
  Vec3f a, b, c;

  Vec3d low() const { return to_double(lower(a, lower(b, c))); }
  Vec3d high() const { return to_double(upper(a, upper(b, c))); }
  Vec3d normal() const { return cross(to_double(b) - to_double(a), to_double(c) - to_double(a)); }
};

Corners corners_of(const IndexedMesh& mesh, const Triangle& triangle) {
  return {mesh.positions[triangle[0]], mesh.positions[triangle[1]], mesh.positions[triangle[2]]};
}

int largest_axis(Vec3d v) {
  const Vec3d size = {std::abs(v.x), std::abs(v.y), std::abs(v.z)};
  return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

/// Calls visit(t) for every triangle, in order. False: cancelled.
template <class Visit>
bool for_each_triangle(const IndexedMesh& mesh, const Progress& progress, const Visit& visit) {
  Stretches stretches(mesh.triangles.size(), progress);
  while (stretches.next()) {
    for (std::size_t t = stretches.begin(); t < stretches.end(); ++t) visit(t);
  }
  return !stretches.are_cancelled();
}

/// Nothing when it is cancelled.
std::optional<double> mean_area(const IndexedMesh& mesh, const Progress& progress) {
  double twice_area = 0;
  const bool is_done = for_each_triangle(
      mesh, progress, [&](std::size_t t) { twice_area += norm(corners_of(mesh, mesh.triangles[t]).normal()); });
  if (!is_done) return std::nullopt;
  return twice_area / 2 / static_cast<double>(mesh.triangles.size());
}

}  // namespace

TriangleGrid::TriangleGrid(const IndexedMesh& mesh, const Progress& progress)
    : mesh_(mesh), low_{kInfinity, kInfinity, kInfinity}, high_{-kInfinity, -kInfinity, -kInfinity} {
  is_built_ = find_box(progress) && choose_cell_size(progress) && sort_triangles_into_cells(progress);
}

bool TriangleGrid::find_box(const Progress& progress) {
  return for_each_triangle(mesh_, progress, [this](std::size_t t) {
    const Corners corners = corners_of(mesh_, mesh_.triangles[t]);
    low_ = lower(low_, corners.low());
    high_ = upper(high_, corners.high());
  });
}

/// Cells about as wide as a triangle, but not many more cells than triangles; wider while slivers that cross many cells
/// fill the lists.
bool TriangleGrid::choose_cell_size(const Progress& progress) {
  const auto area = mean_area(mesh_, progress);
  if (!area) return false;
  const auto triangles = static_cast<double>(mesh_.triangles.size());
  const Vec3d size = high_ - low_;
  cell_size_ = std::max(2 * std::sqrt(*area), 1e-3);
  const auto cells_along = [&](int axis) { return std::floor(size[axis] / cell_size_) + 1; };
  while (cells_along(0) * cells_along(1) * cells_along(2) > 2 * triangles + kFreeCells) cell_size_ *= 1.25;
  const double limit = std::min(16 * (triangles + kFreeCells), 4e9);  // first_ holds 32-bit numbers
  for (;;) {
    cells_per_unit_ = 1 / cell_size_;
    for (int axis = 0; axis < 3; ++axis) shape_[axis] = static_cast<std::int32_t>(cells_along(axis));
    const auto count = count_triangles_in_cells(progress);
    if (!count) return false;
    if (static_cast<double>(*count) <= limit) return true;
    cell_size_ *= 2;
  }
}

/// Where a triangle's plane passes through a column of cells: along the axis that its normal is closest to, the depth
/// is a function of the two other coordinates with slopes of at most 1.
class TriangleGrid::PlaneColumns {
 public:
  PlaneColumns(const Corners& corners, const TriangleGrid& grid) : grid_(grid), on_plane_(to_double(corners.a)) {
    const Vec3d normal = corners.normal();
    depth = largest_axis(normal);
    if (normal[depth] == 0) {  // no plane: every depth is possible
      margin_ = kInfinity;
      return;
    }
    slope_u_ = -normal[u()] / normal[depth];
    slope_v_ = -normal[v()] / normal[depth];
    margin_ = grid.cell_size_ / 2 * (std::abs(slope_u_) + std::abs(slope_v_));
  }

  /// Narrows [first, last] to the cells of the column (first[u], first[v]) that the plane may pass through.
  void clip(Cell& first, Cell& last) const {
    const double center_u = grid_.low_[u()] + (first[u()] + 0.5) * grid_.cell_size_ - on_plane_[u()];
    const double center_v = grid_.low_[v()] + (first[v()] + 0.5) * grid_.cell_size_ - on_plane_[v()];
    const double plane = on_plane_[depth] + slope_u_ * center_u + slope_v_ * center_v;
    first[depth] = std::max(first[depth], grid_.cell_along(depth, plane - margin_));
    last[depth] = std::min(last[depth], grid_.cell_along(depth, plane + margin_));
  }

  int u() const { return (depth + 1) % 3; }
  int v() const { return (depth + 2) % 3; }
  int depth = 0;

 private:
  const TriangleGrid& grid_;
  Vec3d on_plane_;
  double slope_u_ = 0, slope_v_ = 0, margin_ = 0;
};

/// Calls visit(cell number) for every cell that the triangle may touch: those of its bounding box, and when they are
/// many, only those that its plane passes through.
template <class Visit>
void TriangleGrid::for_each_cell_of(const Triangle& triangle, const Visit& visit) const {
  const Corners corners = corners_of(mesh_, triangle);
  const Cell first = cell_at(corners.low()), last = cell_at(corners.high());
  const auto visit_box = [&](const Cell& low, const Cell& high) {
    for (std::int32_t i = low[0]; i <= high[0]; ++i) {
      for (std::int32_t j = low[1]; j <= high[1]; ++j) {
        for (std::int32_t k = low[2]; k <= high[2]; ++k) visit(number_of({i, j, k}));
      }
    }
  };
  const bool is_small = last[0] - first[0] <= 1 && last[1] - first[1] <= 1 && last[2] - first[2] <= 1;
  if (is_small) return visit_box(first, last);

  const PlaneColumns columns(corners, *this);
  const int u = columns.u(), v = columns.v();
  Cell low = first, high = last;
  for (low[u] = first[u]; low[u] <= last[u]; ++low[u]) {
    for (low[v] = first[v]; low[v] <= last[v]; ++low[v]) {
      low[columns.depth] = first[columns.depth], high[columns.depth] = last[columns.depth];
      high[u] = low[u], high[v] = low[v];
      columns.clip(low, high);
      visit_box(low, high);
    }
  }
}

/// Leaves in first_[n] how many triangles cell n holds.
std::optional<std::size_t> TriangleGrid::count_triangles_in_cells(const Progress& progress) {
  first_.assign(static_cast<std::size_t>(shape_[0]) * shape_[1] * shape_[2] + 1, 0);
  std::size_t total = 0;
  const bool is_done = for_each_triangle(mesh_, progress, [&](std::size_t t) {
    for_each_cell_of(mesh_.triangles[t], [&](std::size_t cell) { ++first_[cell], ++total; });
  });
  if (!is_done) return std::nullopt;
  return total;
}

/// Counts become ends; filling from the last triangle on turns each end into a start.
bool TriangleGrid::sort_triangles_into_cells(const Progress& progress) {
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  triangles_.resize(first_.back());
  const std::size_t last = mesh_.triangles.size() - 1;
  return for_each_triangle(mesh_, progress, [&](std::size_t from_last) {
    const std::size_t t = last - from_last;
    for_each_cell_of(mesh_.triangles[t],
                     [&](std::size_t cell) { triangles_[--first_[cell]] = static_cast<std::int32_t>(t); });
  });
}

std::int32_t TriangleGrid::cell_along(int axis, double coordinate) const {
  const double steps = (coordinate - low_[axis]) * cells_per_unit_, last = shape_[axis] - 1;
  const double from_first = steps > 0 ? steps : 0;
  return static_cast<std::int32_t>(from_first < last ? from_first : last);
}

TriangleGrid::Cell TriangleGrid::cell_at(Vec3d point) const {
  return {cell_along(0, point.x), cell_along(1, point.y), cell_along(2, point.z)};
}

double TriangleGrid::squared_distance_to_cell(Vec3d point, Cell cell) const {
  Vec3d offset;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = low_[axis] + cell[axis] * cell_size_;
    offset[axis] = std::max({low - point[axis], point[axis] - (low + cell_size_), 0.0});
  }
  return dot(offset, offset);
}

/// A bound from below: no cell `radius` cells away from the center is nearer. A point outside the grid is at least as
/// far from any cell as its nearest point of the grid is.
double TriangleGrid::distance_to_shell(Vec3d point, Cell center, std::int32_t radius) const {
  double to_face = cell_size_;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = low_[axis] + center[axis] * cell_size_;
    const double inside = std::clamp(point[axis], low, low + cell_size_);
    to_face = std::min({to_face, inside - low, low + cell_size_ - inside});
  }
  return to_face + (radius - 1) * cell_size_;
}

/// The bounding box settles most candidates, for less than the exact distance costs.
void TriangleGrid::consider(Vec3d point, std::int32_t triangle, NearestTriangle& nearest) const {
  const Corners corners = corners_of(mesh_, mesh_.triangles[triangle]);
  const Vec3d outside = upper(upper(corners.low() - point, point - corners.high()), Vec3d{0, 0, 0});
  if (dot(outside, outside) >= nearest.squared_distance) return;
  const double squared_distance =
      squared_distance_to_triangle(point, to_double(corners.a), to_double(corners.b), to_double(corners.c));
  if (squared_distance < nearest.squared_distance) nearest = {squared_distance, triangle};
}

void TriangleGrid::search_cell(Vec3d point, Cell cell, NearestTriangle& nearest) const {
  const std::size_t number = number_of(cell);
  if (first_[number] == first_[number + 1]) return;
  if (squared_distance_to_cell(point, cell) >= nearest.squared_distance) return;
  for (std::uint32_t at = first_[number]; at < first_[number + 1]; ++at) consider(point, triangles_[at], nearest);
}

/// The cells of the grid that are `radius` cells away from the center along one axis and not further along the others.
void TriangleGrid::search_shell(Vec3d point, Cell center, std::int32_t radius, NearestTriangle& nearest) const {
  Cell first, last;
  for (int axis = 0; axis < 3; ++axis) {
    first[axis] = std::max(center[axis] - radius, 0);
    last[axis] = std::min(center[axis] + radius, shape_[axis] - 1);
  }
  for (std::int32_t i = first[0]; i <= last[0]; ++i) {
    for (std::int32_t j = first[1]; j <= last[1]; ++j) {
      const bool on_side = std::abs(i - center[0]) == radius || std::abs(j - center[1]) == radius;
      if (on_side) {
        for (std::int32_t k = first[2]; k <= last[2]; ++k) search_cell(point, {i, j, k}, nearest);
      } else {
        if (center[2] - radius >= 0) search_cell(point, {i, j, center[2] - radius}, nearest);
        if (center[2] + radius < shape_[2]) search_cell(point, {i, j, center[2] + radius}, nearest);
      }
    }
  }
}

NearestTriangle TriangleGrid::find_nearest(Vec3d point, std::int32_t guess) const {
  NearestTriangle nearest{kInfinity, -1};
  if (guess >= 0) consider(point, guess, nearest);
  const Cell center = cell_at(point);
  const std::int32_t radii = std::max({shape_[0], shape_[1], shape_[2]});
  for (std::int32_t radius = 0; radius < radii; ++radius) {
    if (radius > 0) {
      const double bound = distance_to_shell(point, center, radius);
      if (bound * bound >= nearest.squared_distance) break;
    }
    search_shell(point, center, radius, nearest);
  }
  return nearest;
}

}  // namespace geosis
