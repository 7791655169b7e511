#include "engine/volume/node_report.h"

#include <array>
#include <cstdio>
#include <vector>

#include "engine/base/parallel.h"

namespace geosis {
namespace {

/// Cells by how their corners turn, and the first of each kind.
struct Turns {
  std::int64_t right = 0, left = 0;          // corners
  std::int64_t has_right = 0, has_left = 0;  // cells
  std::int64_t first_right = -1, first_left = -1;

  void add_cell(std::int64_t node, int turned_right, int turned_left) {
    right += turned_right;
    left += turned_left;
    if (turned_right > 0 && has_right++ == 0) first_right = node;
    if (turned_left > 0 && has_left++ == 0) first_left = node;
  }
  void add(const Turns& later) {
    right += later.right;
    left += later.left;
    has_right += later.has_right;
    has_left += later.has_left;
    if (first_right < 0) first_right = later.first_right;
    if (first_left < 0) first_left = later.first_left;
  }
};

/// Nodes of a cell at one sample: (inline, crossline) = 00, 01, 10, 11.
using Face = std::array<Vec3d, 4>;

/// The rows of nodes around the cells between four traces.
struct Column {
  std::array<const Vec3f*, 4> rows;

  Face face(std::int32_t k) const {
    return {to_double(rows[0][k]), to_double(rows[1][k]), to_double(rows[2][k]), to_double(rows[3][k])};
  }
};

/// Of a face's corners: the edges along inline and crossline that leave it, crossed. They are half of every
/// determinant.
std::array<Vec3d, 4> crossed_edges(const Face& face) {
  const Vec3d along_i[] = {face[2] - face[0], face[3] - face[1]};  // at crossline 0, 1
  const Vec3d along_j[] = {face[1] - face[0], face[3] - face[2]};  // at inline 0, 1
  return {cross(along_i[0], along_j[0]), cross(along_i[1], along_j[0]), cross(along_i[0], along_j[1]),
          cross(along_i[1], along_j[1])};
}

/// The determinants of the three edges that leave each corner of each cell, seen along the axes.
void look_at_column(const Column& column, std::int32_t samples, std::int64_t first_node, Turns& turns) {
  Face above = column.face(0);
  std::array<Vec3d, 4> crossed_above = crossed_edges(above);
  for (std::int32_t k = 0; k + 1 < samples; ++k) {
    const Face below = column.face(k + 1);
    const std::array<Vec3d, 4> crossed_below = crossed_edges(below);
    int right = 0, left = 0;
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const Vec3d down = below[corner] - above[corner];
      const double turn_above = dot(crossed_above[corner], down), turn_below = dot(crossed_below[corner], down);
      right += (turn_above > 0) + (turn_below > 0);
      left += (turn_above < 0) + (turn_below < 0);
    }
    turns.add_cell(first_node + k, right, left);
    above = below;
    crossed_above = crossed_below;
  }
}

Turns look_at_plane(GridShape shape, std::span<const Vec3f> nodes, std::int32_t i) {
  Turns turns;
  const auto samples = static_cast<std::size_t>(shape.samples);
  const std::size_t plane = static_cast<std::size_t>(shape.crosslines) * samples;
  for (std::int32_t j = 0; j + 1 < shape.crosslines; ++j) {
    const std::size_t first = static_cast<std::size_t>(i) * plane + static_cast<std::size_t>(j) * samples;
    const Vec3f* const row = nodes.data() + first;
    look_at_column({{row, row + samples, row + plane, row + plane + samples}}, shape.samples,
                   static_cast<std::int64_t>(first), turns);
  }
  return turns;
}

}  // namespace

Result<NodeReport> look_at_cells(GridShape shape, std::span<const Vec3f> nodes, int threads) {
  std::vector<Turns> planes(static_cast<std::size_t>(shape.inlines - 1));
  parallel_for(planes.size(), threads,
               [&](std::size_t i) { planes[i] = look_at_plane(shape, nodes, static_cast<std::int32_t>(i)); });
  Turns all;
  for (const Turns& plane : planes) all.add(plane);
  NodeReport report;
  report.mirrored = all.left > all.right;
  report.folded_cells = report.mirrored ? all.has_right : all.has_left;
  const std::int64_t cells = GridShape{shape.inlines - 1, shape.crosslines - 1, shape.samples - 1}.count();
  report.folded_share = static_cast<double>(report.folded_cells) / static_cast<double>(cells);
  if (report.folded_share <= kMostFolded) return report;
  char share[80];
  std::snprintf(share, sizeof share, "%.1f %% of the cells are folded; at most %.0f %%", 100 * report.folded_share,
                100 * kMostFolded);
  const std::int64_t example = report.mirrored ? all.first_right : all.first_left;
  return bad_positions(std::string(share) + "; the first is that from " +
                       name_of_node(shape, static_cast<std::size_t>(example)));
}

std::string name_of_node(GridShape shape, std::size_t number) {
  const auto samples = static_cast<std::size_t>(shape.samples), crosslines = static_cast<std::size_t>(shape.crosslines);
  return "node [" + std::to_string(number / samples / crosslines) + "," +
         std::to_string(number / samples % crosslines) + "," + std::to_string(number % samples) + "]";
}

Error bad_positions(const std::string& what) {
  return {ErrorCode::malformed_input, "node positions: " + what};
}

}  // namespace geosis
