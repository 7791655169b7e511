#include "engine/mesh/corner_table.h"

#include <algorithm>
#include <limits>
#include <span>
#include <string>
#include <utility>

#include "engine/base/stretches.h"

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

Error cancelled() {
  return {ErrorCode::cancelled, "building a corner table was cancelled"};
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

Result<void> fill_vertices(const IndexedMesh& mesh, const Progress& progress, CornerTable& table) {
  table.vertex.resize(mesh.triangles.size() * 3);
  Stretches stretches(mesh.triangles.size(), progress);
  while (stretches.next()) {
    for (std::size_t t = stretches.begin(); t < stretches.end(); ++t) {
      const Triangle& triangle = mesh.triangles[t];
      if (!is_sound(triangle, mesh.positions.size())) return triangle_fault(triangle, t, mesh.positions.size());
      std::copy_n(triangle.begin(), 3, &table.vertex[3 * t]);
    }
  }
  if (stretches.are_cancelled()) return cancelled();
  return {};
}

/// Edges are matched in at most this many rounds, for the memory's sake: each takes a scan of all corners.
constexpr std::uint32_t kMostRounds = 4;
constexpr std::uint32_t kLeastCornersARound = 1u << 18;

/// Ends of the edge that corner c faces, the lower one first.
std::pair<std::int32_t, std::int32_t> ends_of_edge(const CornerTable& table, std::int32_t c) {
  return std::minmax({table.vertex[CornerTable::next(c)], table.vertex[CornerTable::previous(c)]});
}

/// Calls visit(c) for every corner. False: cancelled.
template <class Visit>
bool for_each_corner(const CornerTable& table, const Progress& progress, const Visit& visit) {
  Stretches stretches(table.vertex.size(), progress);
  while (stretches.next()) {
    for (std::size_t c = stretches.begin(); c < stretches.end(); ++c) visit(static_cast<std::int32_t>(c));
  }
  return !stretches.are_cancelled();
}

/// (vertices + 1) How many corners face edges whose lower end is below vertex v.
Result<std::vector<std::uint32_t>> count_edges_below(const CornerTable& table, std::size_t vertices,
                                                     const Progress& progress) {
  std::vector<std::uint32_t> below(vertices + 1, 0);
  const auto count = [&](std::int32_t c) { ++below[ends_of_edge(table, c).first + 1]; };
  if (!for_each_corner(table, progress, count)) return cancelled();
  for (std::size_t v = 1; v < below.size(); ++v) below[v] += below[v - 1];
  return below;
}

/// Edge entries of some lower vertices, grouped by these: those of vertex begin + i are entries[first[i]] ...
/// entries[first[i + 1] - 1].
struct EdgeGroups {
  std::int32_t begin;
  std::vector<std::uint32_t> first;
  std::vector<EdgeEntry> entries;

  std::size_t size() const { return first.size() - 1; }
  std::span<EdgeEntry> of(std::size_t i) { return std::span(entries).subspan(first[i], first[i + 1] - first[i]); }
};

/// Of the lower vertices begin ... end - 1.
Result<EdgeGroups> group_edges(const CornerTable& table, const std::vector<std::uint32_t>& below, std::size_t begin,
                               std::size_t end, const Progress& progress) {
  EdgeGroups groups{static_cast<std::int32_t>(begin), {}, std::vector<EdgeEntry>(below[end] - below[begin])};
  groups.first.reserve(end - begin + 1);
  for (std::size_t v = begin; v <= end; ++v) groups.first.push_back(below[v] - below[begin]);
  std::vector<std::uint32_t> next(groups.first.begin(), groups.first.end() - 1);
  const bool is_done = for_each_corner(table, progress, [&](std::int32_t c) {
    const auto [lower, higher] = ends_of_edge(table, c);
    const std::size_t group = static_cast<std::size_t>(lower) - begin;  // wraps around below begin
    if (group < next.size()) groups.entries[next[group]++] = make_entry(higher, c);
  });
  if (!is_done) return cancelled();
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

Result<void> match_edges_of(EdgeGroups& groups, std::size_t group, CornerTable& table) {
  const std::span<EdgeEntry> entries = groups.of(group);
  std::sort(entries.begin(), entries.end());
  for (std::size_t i = 0; i < entries.size();) {
    const auto edge = edge_at(entries, i);
    if (!match(edge, table)) return edge_fault(groups.begin + static_cast<std::int32_t>(group), edge);
    i += edge.size();
  }
  return {};
}

Result<void> match_edges(EdgeGroups& groups, const Progress& progress, CornerTable& table) {
  Stretches stretches(groups.size(), progress);
  while (stretches.next()) {
    for (std::size_t group = stretches.begin(); group < stretches.end(); ++group) {
      if (auto matched = match_edges_of(groups, group, table); !matched) return matched;
    }
  }
  if (stretches.are_cancelled()) return cancelled();
  return {};
}

/// In rounds over ranges of lower vertices.
Result<void> match_all_edges(CornerTable& table, std::size_t vertices, const Progress& progress) {
  const auto counted = count_edges_below(table, vertices, progress);
  if (!counted) return counted.error();
  const std::vector<std::uint32_t>& below = *counted;
  const std::uint32_t corners_a_round = std::max(kLeastCornersARound, below.back() / kMostRounds + 1);
  for (std::size_t begin = 0; begin < vertices;) {
    const auto past = std::upper_bound(below.begin() + begin + 2, below.end(), below[begin] + corners_a_round);
    const auto end = static_cast<std::size_t>(past - below.begin()) - 1;
    auto groups = group_edges(table, below, begin, end, progress);
    if (!groups) return std::move(groups).error();
    if (auto matched = match_edges(*groups, progress, table); !matched) return matched;
    begin = end;
  }
  return {};
}

}  // namespace

Result<CornerTable> build_corner_table(const IndexedMesh& mesh, const Progress& progress) {
  constexpr std::size_t kMaxIndex = std::numeric_limits<std::int32_t>::max();
  if (mesh.triangles.size() > kMaxIndex / 3 || mesh.positions.size() > kMaxIndex) {
    return Error{ErrorCode::limit_exceeded,
                 std::to_string(mesh.triangles.size()) + " triangles over " + std::to_string(mesh.positions.size()) +
                     " vertices; a corner table holds at most " + std::to_string(kMaxIndex / 3) + " triangles"};
  }
  CornerTable table;
  if (auto filled = fill_vertices(mesh, progress, table); !filled) return std::move(filled).error();
  table.opposite.assign(table.vertex.size(), CornerTable::kNoCorner);
  auto matched = match_all_edges(table, mesh.positions.size(), progress);
  if (!matched) return std::move(matched).error();
  return table;
}

}  // namespace geosis
