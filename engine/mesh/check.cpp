#include "engine/mesh/check.h"

#include <string>
#include <utility>
#include <vector>

namespace geosis {
namespace {

/// Corners of c's vertex that are connected with c across edges.
std::int32_t fan_size(const CornerTable& table, std::int32_t c) {
  std::int32_t size = 1;
  std::int32_t at = table.swing(c);
  for (; at != CornerTable::kNoCorner; at = table.swing(at)) {
    if (at == c) return size;
    ++size;
  }
  // An open fan: the other part lies clockwise of c.
  for (at = c;; ++size) {
    const std::int32_t across = table.opposite[CornerTable::previous(at)];
    if (across == CornerTable::kNoCorner) return size;
    at = CornerTable::previous(across);
  }
}

/// Triangles on the same vertices meet across all three edges once each edge has at most two triangles, so it is enough
/// to compare what lies across two of them.
Result<void> check_duplicates(const CornerTable& table) {
  for (std::int32_t c = 0; c < table.corners(); c += 3) {
    const std::int32_t first = table.opposite[c];
    const std::int32_t second = table.opposite[c + 1];
    if (first == CornerTable::kNoCorner || second == CornerTable::kNoCorner) continue;
    if (CornerTable::triangle(first) != CornerTable::triangle(second)) continue;
    return Error{ErrorCode::invalid_argument, "triangles " + std::to_string(CornerTable::triangle(c)) + " and " +
                                                  std::to_string(CornerTable::triangle(first)) +
                                                  " have the same three vertices"};
  }
  return {};
}

}  // namespace

Result<void> check_fans(const CornerTable& table, std::size_t vertices) {
  std::vector<std::int32_t> some_corner(vertices, CornerTable::kNoCorner);
  std::vector<std::int32_t> valence(vertices, 0);
  for (std::int32_t c = 0; c < table.corners(); ++c) {
    some_corner[table.vertex[c]] = c;
    ++valence[table.vertex[c]];
  }
  for (std::size_t v = 0; v < vertices; ++v) {
    if (valence[v] == 0) continue;
    const std::int32_t size = fan_size(table, some_corner[v]);
    if (size == valence[v]) continue;
    return Error{ErrorCode::invalid_argument, "vertex " + std::to_string(v) +
                                                  " has more than one fan: " + std::to_string(size) + " of its " +
                                                  std::to_string(valence[v]) + " triangles are connected across edges"};
  }
  return {};
}

Result<void> check_manifold(const IndexedMesh& mesh) {
  const auto table = build_corner_table(mesh);
  if (!table) return table.error();
  if (auto distinct = check_duplicates(*table); !distinct) return distinct;
  return check_fans(*table, mesh.positions.size());
}

}  // namespace geosis
