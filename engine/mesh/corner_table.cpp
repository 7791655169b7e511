#include "engine/mesh/corner_table.h"

#include <algorithm>
#include <limits>
#include <span>
#include <string>

namespace geosis {
namespace {

/// A corner's facing edge, seen from the lower of its two vertices: higher vertex in the upper half, corner in the
/// lower, so that sorting the entries of one lower vertex brings the corners of an edge together.
using EdgeEntry = std::uint64_t;

EdgeEntry make_entry(std::int32_t higher, std::int32_t corner) {
  return static_cast<EdgeEntry>(static_cast<std::uint32_t>(higher)) << 32 | static_cast<std::uint32_t>(corner);
}
std::int32_t higher_of(EdgeEntry entry) {
  return static_cast<std::int32_t>(entry >> 32);
}
std::int32_t corner_of(EdgeEntry entry) {
  return static_cast<std::int32_t>(entry & 0xffffffffu);
}

Error fault(std::string message) {
  return {ErrorCode::invalid_argument, std::move(message)};
}

bool is_sound(const Triangle& triangle, std::size_t vertices) {
  const auto [a, b, c] = triangle;
  const auto in_range = [&](std::int32_t v) { return static_cast<std::uint32_t>(v) < vertices; };
  return in_range(a) && in_range(b) && in_range(c) && a != b && b != c && c != a;
}

Error triangle_fault(const Triangle& triangle, std::size_t index, std::size_t vertices) {
  const std::string name = "triangle " + std::to_string(index);
  for (const std::int32_t v : triangle) {
    if (v >= 0 && static_cast<std::size_t>(v) < vertices) continue;
    return fault(name + ": vertex index " + std::to_string(v) + "; expected 0.." +
                 std::to_string(static_cast<std::int64_t>(vertices) - 1));
  }
  const auto [a, b, c] = triangle;
  return fault(name + " names vertex " + std::to_string(a == b ? a : c) + " twice");
}

Result<void> fill_vertices(const IndexedMesh& mesh, CornerTable& table) {
  table.vertex.resize(mesh.triangles.size() * 3);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& triangle = mesh.triangles[t];
    if (!is_sound(triangle, mesh.positions.size())) return triangle_fault(triangle, t, mesh.positions.size());
    std::copy_n(triangle.begin(), 3, &table.vertex[3 * t]);
  }
  return {};
}

/// All edge entries, grouped by lower vertex: those of vertex v are entries[first[v]] ... entries[first[v + 1] - 1].
struct EdgeGroups {
  std::vector<std::uint32_t> first;
  std::vector<EdgeEntry> entries;

  std::span<EdgeEntry> of(std::size_t v) { return std::span(entries).subspan(first[v], first[v + 1] - first[v]); }
};

EdgeGroups group_edges(const CornerTable& table, std::size_t vertices) {
  const auto ends = [&](std::int32_t c) {
    return std::minmax(table.vertex[CornerTable::next(c)], table.vertex[CornerTable::previous(c)]);
  };
  EdgeGroups groups{std::vector<std::uint32_t>(vertices + 2, 0), std::vector<EdgeEntry>(table.vertex.size())};
  // Counts go two places up, so that after the sums first[v + 1] is where v's next entry goes and ends as v + 1's
  // first.
  for (std::int32_t c = 0; c < table.corners(); ++c) ++groups.first[ends(c).first + 2];
  for (std::size_t v = 2; v < groups.first.size(); ++v) groups.first[v] += groups.first[v - 1];
  for (std::int32_t c = 0; c < table.corners(); ++c) {
    const auto [lower, higher] = ends(c);
    groups.entries[groups.first[lower + 1]++] = make_entry(higher, c);
  }
  return groups;
}

/// The entries from `begin` on that belong to the same edge.
std::span<const EdgeEntry> edge_at(std::span<const EdgeEntry> entries, std::size_t begin) {
  std::size_t end = begin + 1;
  while (end < entries.size() && higher_of(entries[end]) == higher_of(entries[begin])) ++end;
  return entries.subspan(begin, end - begin);
}

/// Makes the corners of one edge each other's opposites; false if they cannot be.
bool match(std::span<const EdgeEntry> edge, CornerTable& table) {
  if (edge.size() == 1) return true;
  const std::int32_t a = corner_of(edge[0]);
  const std::int32_t b = corner_of(edge[1]);
  if (edge.size() > 2 || table.vertex[CornerTable::next(a)] == table.vertex[CornerTable::next(b)]) return false;
  table.opposite[a] = b;
  table.opposite[b] = a;
  return true;
}

Error edge_fault(std::int32_t lower, std::span<const EdgeEntry> edge) {
  const std::string name = "edge of vertices " + std::to_string(lower) + " and " + std::to_string(higher_of(edge[0]));
  const auto triangle = [&](std::size_t i) { return std::to_string(CornerTable::triangle(corner_of(edge[i]))); };
  if (edge.size() == 2) {
    return fault("triangles " + triangle(0) + " and " + triangle(1) + " run in the same direction along the " + name);
  }
  return fault(name + " lies in " + std::to_string(edge.size()) + " triangles: " + triangle(0) + " " + triangle(1) +
               " " + triangle(2) + (edge.size() > 3 ? " ..." : ""));
}

Result<void> match_edges(EdgeGroups& groups, CornerTable& table) {
  for (std::size_t v = 0; v + 2 < groups.first.size(); ++v) {
    const std::span<EdgeEntry> entries = groups.of(v);
    std::sort(entries.begin(), entries.end());
    for (std::size_t i = 0; i < entries.size();) {
      const auto edge = edge_at(entries, i);
      if (!match(edge, table)) return edge_fault(static_cast<std::int32_t>(v), edge);
      i += edge.size();
    }
  }
  return {};
}

}  // namespace

Result<CornerTable> build_corner_table(const IndexedMesh& mesh) {
  constexpr std::size_t kMaxIndex = std::numeric_limits<std::int32_t>::max();
  if (mesh.triangles.size() > kMaxIndex / 3 || mesh.positions.size() > kMaxIndex) {
    return Error{ErrorCode::limit_exceeded,
                 std::to_string(mesh.triangles.size()) + " triangles over " + std::to_string(mesh.positions.size()) +
                     " vertices; a corner table holds at most " + std::to_string(kMaxIndex / 3) + " triangles"};
  }
  CornerTable table;
  if (auto filled = fill_vertices(mesh, table); !filled) return std::move(filled).error();
  table.opposite.assign(table.vertex.size(), CornerTable::kNoCorner);

  EdgeGroups groups = group_edges(table, mesh.positions.size());
  if (auto matched = match_edges(groups, table); !matched) return std::move(matched).error();
  return table;
}

}  // namespace geosis
