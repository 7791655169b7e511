#include "engine/mesh/check.h"

#include <string>
#include <utility>
#include <vector>

#include "engine/base/stretches.h"

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

Error fan_fault(std::size_t vertex, std::int32_t size, std::int32_t valence) {
  return {ErrorCode::invalid_argument, "vertex " + std::to_string(vertex) +
                                           " has more than one fan: " + std::to_string(size) + " of its " +
                                           std::to_string(valence) + " triangles are connected across edges"};
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

Result<void> check_fans(const CornerTable& table, std::size_t vertices, const Progress& progress) {
  std::vector<std::int32_t> some_corner(vertices, CornerTable::kNoCorner);
  std::vector<std::int32_t> valence(vertices, 0);
  const Error cancelled = {ErrorCode::cancelled, "checking the fans of a mesh was cancelled"};
  Stretches corners(table.vertex.size(), progress);
  while (corners.next()) {
    for (std::size_t c = corners.begin(); c < corners.end(); ++c) {
      some_corner[table.vertex[c]] = static_cast<std::int32_t>(c);
      ++valence[table.vertex[c]];
    }
  }
  if (corners.are_cancelled()) return cancelled;
  Stretches fans(vertices, progress);
  while (fans.next()) {
    for (std::size_t v = fans.begin(); v < fans.end(); ++v) {
      if (valence[v] == 0) continue;
      const std::int32_t size = fan_size(table, some_corner[v]);
      if (size != valence[v]) return fan_fault(v, size, valence[v]);
    }
  }
  if (fans.are_cancelled()) return cancelled;
  return {};
}

Result<void> check_manifold(const IndexedMesh& mesh) {
  const auto table = build_corner_table(mesh);
  if (!table) return table.error();
  if (auto distinct = check_duplicates(*table); !distinct) return distinct;
  return check_fans(*table, mesh.positions.size());
}

}  // namespace geosis
