#include "engine/mesh/operators.h"

#include <algorithm>
#include <vector>

namespace geosis {
namespace {

constexpr std::int32_t kNone = CornerTable::kNoCorner;

std::int32_t next(std::int32_t c) {
  return CornerTable::next(c);
}
std::int32_t previous(std::int32_t c) {
  return CornerTable::previous(c);
}

/// The corners at one vertex; of an open fan clockwise end first.
struct CornerFan {
  std::vector<std::int32_t> corners;
  bool is_open = false;
};

CornerFan fan_of(const CornerTable& table, std::int32_t c) {
  std::int32_t first = c;
  CornerFan fan;
  for (;;) {  // clockwise
    const std::int32_t across = table.opposite[previous(first)];
    fan.is_open = across == kNone;
    if (fan.is_open) break;
    first = previous(across);
    if (first == c) break;
  }
  for (std::int32_t at = first; at != kNone; at = table.swing(at)) {
    if (!fan.corners.empty() && at == first) break;
    fan.corners.push_back(at);
  }
  return fan;
}

/// The vertices around, each once.
std::vector<std::int32_t> link_of(const CornerTable& table, const CornerFan& fan) {
  std::vector<std::int32_t> link;
  for (const std::int32_t c : fan.corners) link.push_back(table.vertex[next(c)]);
  if (fan.is_open) link.push_back(table.vertex[previous(fan.corners.back())]);
  return link;
}

bool contains(const std::vector<std::int32_t>& list, std::int32_t value) {
  return std::find(list.begin(), list.end(), value) != list.end();
}

void join(CornerTable& table, std::int32_t a, std::int32_t b) {
  if (a != kNone) table.opposite[a] = b;
  if (b != kNone) table.opposite[b] = a;
}

/// Closes the gap where c's triangle was, once the ends of the edge that c faces are one vertex.
void take_out(CornerTable& table, std::int32_t c) {
  join(table, table.opposite[next(c)], table.opposite[previous(c)]);
  for (const std::int32_t corner : {c, next(c), previous(c)}) {
    table.vertex[corner] = kGone;
    table.opposite[corner] = kNone;
  }
}

/// The ends of the edge that c faces become one vertex, `kept`. Returns a corner there.
std::int32_t merge_ends(CornerTable& table, std::int32_t c, std::int32_t kept) {
  for (const std::int32_t end : {next(c), previous(c)}) {
    for (const std::int32_t corner : fan_of(table, end).corners) table.vertex[corner] = kept;
  }
  const std::int32_t beside = table.opposite[previous(c)];
  const std::int32_t stays = beside != kNone ? next(beside) : previous(table.opposite[next(c)]);
  const std::int32_t across = table.opposite[c];
  take_out(table, c);
  if (across != kNone) take_out(table, across);
  return stays;
}

/// The corner that faces the edge between c's vertex and v; kNone if there is none.
std::int32_t corner_facing(const CornerTable& table, std::int32_t c, std::int32_t v) {
  for (const std::int32_t at : fan_of(table, c).corners) {
    if (table.vertex[next(at)] == v) return previous(at);
    if (table.vertex[previous(at)] == v) return next(at);
  }
  return kNone;
}

/// Triangles as they were, to be put back.
class Snapshot {
 public:
  /// All triangles at the vertices of these corners: whatever merges those vertices changes no others.
  Snapshot(const CornerTable& table, const std::vector<std::int32_t>& corners) {
    for (const std::int32_t c : corners) {
      for (const std::int32_t at : fan_of(table, c).corners) {
        for (const std::int32_t k : {at, next(at), previous(at)})
          saved_.push_back({k, table.vertex[k], table.opposite[k]});
      }
    }
  }
  void put_back(CornerTable& table) const {
    for (const auto& [c, vertex, opposite] : saved_) {
      table.vertex[c] = vertex;
      table.opposite[c] = opposite;
    }
  }

 private:
  struct Saved {
    std::int32_t corner, vertex, opposite;
  };
  std::vector<Saved> saved_;
};

/// Merges the vertices of all corners into that of the first, or leaves the table as it was.
bool merge_all(CornerTable& table, const std::vector<std::int32_t>& corners) {
  const Snapshot before(table, corners);
  std::int32_t at = corners[0];
  const std::int32_t kept = table.vertex[at];
  std::vector<std::int32_t> to_merge;
  for (std::size_t i = 1; i < corners.size(); ++i) to_merge.push_back(table.vertex[corners[i]]);
  for (const std::int32_t v : to_merge) {
    const std::int32_t facing = corner_facing(table, at, v);
    if (facing == kNone || !has_link_condition(table, facing)) {
      before.put_back(table);
      return false;
    }
    at = merge_ends(table, facing, kept);
  }
  return true;
}

}  // namespace

bool has_link_condition(const CornerTable& table, std::int32_t c) {
  const CornerFan kept = fan_of(table, next(c));
  const CornerFan gone = fan_of(table, previous(c));
  const std::int32_t across = table.opposite[c];
  const std::size_t shared = across == kNone ? 1 : 2;
  // Each boundary loop counts as closed by one more vertex: an inner edge between two boundary vertices has it in its
  // vertices' links, not in its own.
  if (kept.is_open && gone.is_open && shared == 2) return false;
  const auto link = link_of(table, kept);
  std::size_t common = 0;
  for (const std::int32_t v : link_of(table, gone)) common += contains(link, v);
  if (common != shared) return false;
  // A tetrahedron, or two triangles back to back, and a single triangle have nothing to give.
  const bool closed = !kept.is_open && !gone.is_open;
  if (closed && kept.corners.size() == 3 && gone.corners.size() == 3) return false;
  return kept.corners.size() + gone.corners.size() > 2 * shared;
}

bool flip_edge(CornerTable& table, std::int32_t c) {
  const std::int32_t o = table.opposite[c];
  if (o == kNone) return false;
  const std::int32_t from = table.vertex[c];
  const std::int32_t to = table.vertex[o];
  if (from == to || contains(link_of(table, fan_of(table, c)), to)) return false;
  // Triangles (c, n, p) and (o, p, n) become (c, n, o) and (o, p, c), on the same corners.
  const std::int32_t n = next(c), p = previous(c), n_across = next(o), p_across = previous(o);
  const std::int32_t beyond_n = table.opposite[n];                // across p -> c
  const std::int32_t beyond_n_across = table.opposite[n_across];  // across n -> o
  table.vertex[p] = to;
  table.vertex[p_across] = from;
  join(table, c, beyond_n_across);
  if (beyond_n_across == kNone) table.opposite[c] = kNone;
  join(table, o, beyond_n);
  if (beyond_n == kNone) table.opposite[o] = kNone;
  join(table, n, n_across);
  return true;
}

bool collapse_edge(CornerTable& table, std::int32_t c) {
  if (!has_link_condition(table, c)) return false;
  merge_ends(table, c, table.vertex[next(c)]);
  return true;
}

bool weld_edge(CornerTable& table, std::int32_t c) {
  const CornerFan fan = fan_of(table, c);
  if (fan.corners.size() != (fan.is_open ? 2u : 4u)) return false;
  return collapse_edge(table, next(c));
}

bool collapse_face(CornerTable& table, std::int32_t c) {
  return merge_all(table, {c, next(c), previous(c)});
}

bool collapse_star(CornerTable& table, std::int32_t c) {
  const CornerFan fan = fan_of(table, c);
  if (fan.is_open) return false;
  std::vector<std::int32_t> corners = {c};
  for (const std::int32_t at : fan.corners) corners.push_back(next(at));
  return merge_all(table, corners);
}

CornerTable remove_gone_triangles(const CornerTable& table) {
  std::vector<std::int32_t> place(table.vertex.size(), kNone);
  CornerTable result;
  for (std::int32_t c = 0; c < table.corners(); ++c) {
    if (table.vertex[c] == kGone) continue;
    place[c] = static_cast<std::int32_t>(result.vertex.size());
    result.vertex.push_back(table.vertex[c]);
  }
  for (std::int32_t c = 0; c < table.corners(); ++c) {
    if (table.vertex[c] == kGone) continue;
    result.opposite.push_back(table.opposite[c] == kNone ? kNone : place[table.opposite[c]]);
  }
  return result;
}

}  // namespace geosis
