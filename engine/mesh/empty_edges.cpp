#include "engine/mesh/empty_edges.h"

#include <cstddef>
#include <utility>

#include "engine/base/stretches.h"
#include "engine/mesh/corner_table.h"
#include "engine/mesh/operators.h"

namespace geosis {
namespace {

constexpr int kMostPasses = 8;  // a collapse may make room for one that was refused before it

/// One look at every edge. Returns how many collapsed; -1 when cancelled.
std::int64_t collapse_once(const std::vector<Vec3f>& positions, CornerTable& table, const Progress& progress) {
  std::int64_t collapsed = 0;
  Stretches stretches(static_cast<std::size_t>(table.corners()), progress);
  while (stretches.next()) {
    for (std::size_t n = stretches.begin(); n < stretches.end(); ++n) {
      const auto c = static_cast<std::int32_t>(n);
      if (table.vertex[c] == kGone) continue;
      const std::int32_t a = table.vertex[CornerTable::next(c)], b = table.vertex[CornerTable::previous(c)];
      if (positions[a] == positions[b] && collapse_edge(table, c)) ++collapsed;
    }
  }
  return stretches.are_cancelled() ? -1 : collapsed;
}

/// Vertices that a triangle uses, numbered in their order.
std::vector<std::int32_t> number_used(const CornerTable& table, std::size_t vertices) {
  std::vector<std::int32_t> index(vertices, -1);
  for (const std::int32_t v : table.vertex) {
    if (v != kGone) index[static_cast<std::size_t>(v)] = 0;
  }
  std::int32_t used = 0;
  for (std::int32_t& i : index) {
    if (i == 0) i = used++;
  }
  return index;
}

}  // namespace

Result<std::vector<std::int32_t>> collapse_empty_edges(IndexedMesh& mesh, const Progress& progress) {
  auto table = build_corner_table(mesh, progress);
  if (!table) return std::move(table).error();
  for (int pass = 0; pass < kMostPasses; ++pass) {
    const std::int64_t collapsed = collapse_once(mesh.positions, *table, progress);
    if (collapsed < 0) return Error{ErrorCode::cancelled, "merging the ends of empty edges was cancelled"};
    if (collapsed == 0) break;
  }
  std::vector<std::int32_t> index = number_used(*table, mesh.positions.size());
  std::size_t kept = 0;
  for (std::size_t v = 0; v < index.size(); ++v) {
    if (index[v] >= 0) mesh.positions[kept++] = mesh.positions[v];
  }
  mesh.positions.resize(kept);
  mesh.triangles.clear();
  for (std::int32_t c = 0; c < table->corners(); c += 3) {
    if (table->vertex[c] == kGone) continue;
    mesh.triangles.push_back({index[table->vertex[c]], index[table->vertex[c + 1]], index[table->vertex[c + 2]]});
  }
  return index;
}

}  // namespace geosis
