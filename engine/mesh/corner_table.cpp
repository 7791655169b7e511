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

std::string edge_name(std::int32_t lower, std::int32_t higher) {
  return "edge of vertices " + std::to_string(lower) + " and " + std::to_string(higher);
}

Result<void> check_triangle(const Triangle& triangle, std::size_t index, std::size_t vertices) {
  for (const std::int32_t v : triangle) {
    if (v < 0 || static_cast<std::size_t>(v) >= vertices) {
      return fault("triangle " + std::to_string(index) + ": vertex index " + std::to_string(v) + "; expected 0.." +
                   std::to_string(static_cast<std::int64_t>(vertices) - 1));
    }
  }
  const auto [a, b, c] = triangle;
  if (a == b || b == c || c == a) {
    return fault("triangle " + std::to_string(index) + " names vertex " + std::to_string(a == b ? a : c) + " twice");
  }
  return {};
}

Result<void> fill_vertices(const IndexedMesh& mesh, CornerTable& table) {
  table.vertex.resize(mesh.triangles.size() * 3);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (auto sound = check_triangle(mesh.triangles[t], t, mesh.positions.size()); !sound) return sound;
    std::copy_n(mesh.triangles[t].begin(), 3, table.vertex.begin() + static_cast<std::ptrdiff_t>(3 * t));
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

Error too_many_triangles(std::int32_t lower, std::span<const EdgeEntry> run) {
  std::string message = edge_name(lower, higher_of(run[0])) + " lies in " + std::to_string(run.size()) + " triangles:";
  for (const EdgeEntry entry : run.first(3)) {
    message.append(" ").append(std::to_string(CornerTable::triangle(corner_of(entry))));
  }
  return fault(std::move(message) + (run.size() > 3 ? " ..." : ""));
}

/// Makes the corners of one edge each other's opposites.
Result<void> match(std::int32_t lower, std::span<const EdgeEntry> run, CornerTable& table) {
  if (run.size() == 1) return {};
  if (run.size() > 2) return too_many_triangles(lower, run);
  const std::int32_t a = corner_of(run[0]);
  const std::int32_t b = corner_of(run[1]);
  if (table.vertex[CornerTable::next(a)] == table.vertex[CornerTable::next(b)]) {
    return fault("triangles " + std::to_string(CornerTable::triangle(a)) + " and " +
                 std::to_string(CornerTable::triangle(b)) + " run in the same direction along the " +
                 edge_name(lower, higher_of(run[0])));
  }
  table.opposite[a] = b;
  table.opposite[b] = a;
  return {};
}

Result<void> match_edges(std::int32_t lower, std::span<EdgeEntry> entries, CornerTable& table) {
  std::sort(entries.begin(), entries.end());
  for (std::size_t i = 0; i < entries.size();) {
    std::size_t end = i + 1;
    while (end < entries.size() && higher_of(entries[end]) == higher_of(entries[i])) ++end;
    if (auto matched = match(lower, entries.subspan(i, end - i), table); !matched) return matched;
    i = end;
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
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    auto matched = match_edges(static_cast<std::int32_t>(v), groups.of(v), table);
    if (!matched) return std::move(matched).error();
  }
  return table;
}

}  // namespace geosis
