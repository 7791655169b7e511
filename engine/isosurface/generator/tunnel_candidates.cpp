#include "engine/isosurface/generator/tunnel_candidates.h"

#include <algorithm>
#include <map>
#include <set>

#include "engine/isosurface/generator/cell_loops.h"

namespace geosis::generator {
namespace {

/// Geometries that a greedy step looks at to choose the next patch.
constexpr std::size_t kJury = 64;
constexpr std::array<std::uint8_t, 5> kDepths = {1, 2, 4, 8, 16};

/// The same triangle, smallest corner first.
PatchTriangle turned(PatchTriangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

bool repeats_an_edge(const CellPatch& patch) {
  std::set<std::pair<int, int>> directed;
  for (const auto& t : patch) {
    for (int n = 0; n < 3; ++n) {
      if (!directed.insert({t[n], t[(n + 1) % 3]}).second) return true;
    }
  }
  return false;
}

/// All triangulations of a polygon in which corners may repeat; no side but the polygon's is a segment of a loop.
class PolygonPatches {
 public:
  PolygonPatches(const CellLoops& loops, std::vector<int> polygon) : loops_(loops), polygon_(std::move(polygon)) {}

  const std::vector<CellPatch>& all() { return between(0, static_cast<int>(polygon_.size()) - 1); }

 private:
  bool side_possible(int a, int b) const {
    return b - a == 1 || (polygon_[a] != polygon_[b] && !is_segment(loops_, polygon_[a], polygon_[b]));
  }

  // Sub-polygon a, a + 1, ..., b, closed by the chord (a, b).
  const std::vector<CellPatch>& between(int a, int b) {
    if (const auto known = memory_.find({a, b}); known != memory_.end()) return known->second;
    std::vector<CellPatch> patches;
    if (b - a < 2) patches.emplace_back();
    for (int m = a + 1; m < b; ++m) {
      if (!side_possible(a, m) || !side_possible(m, b) || polygon_[a] == polygon_[b]) continue;
      const PatchTriangle apex = turned({polygon_[a], polygon_[m], polygon_[b]});
      for (const CellPatch& left : between(a, m)) {
        for (const CellPatch& right : between(m, b)) {
          CellPatch patch = left;
          patch.insert(patch.end(), right.begin(), right.end());
          patch.push_back(apex);
          if (!repeats_an_edge(patch)) patches.push_back(std::move(patch));
        }
      }
    }
    return memory_[{a, b}] = std::move(patches);
  }

  const CellLoops& loops_;
  const std::vector<int> polygon_;
  std::map<std::pair<int, int>, std::vector<CellPatch>> memory_;
};

/// All annuli between two loops, whoever owns their chords: cut along each bridge, an annulus is a polygon.
std::set<CellPatch> annuli(const CellLoops& loops, const std::vector<int>& p, const std::vector<int>& q) {
  std::set<CellPatch> found;
  for (std::size_t i = 0; i < p.size(); ++i) {
    for (std::size_t j = 0; j < q.size(); ++j) {
      if (is_segment(loops, p[i], q[j])) continue;
      std::vector<int> polygon;
      for (std::size_t n = 0; n <= p.size(); ++n) polygon.push_back(p[(i + n) % p.size()]);
      for (std::size_t n = 0; n <= q.size(); ++n) polygon.push_back(q[(j + n) % q.size()]);
      PolygonPatches patches(loops, std::move(polygon));
      for (CellPatch patch : patches.all()) {
        std::sort(patch.begin(), patch.end());
        found.insert(std::move(patch));
      }
    }
  }
  return found;
}

/// Edges between two triangles of the patch that the cell may not draw.
std::vector<std::array<int, 2>> forbidden_chords(const CellState& state, const CellLoops& loops,
                                                 const CellPatch& patch) {
  std::vector<std::array<int, 2>> chords;
  for (const auto& t : patch) {
    for (int n = 0; n < 3; ++n) {
      const int a = t[n], b = t[(n + 1) % 3];
      if (a < b && !is_segment(loops, a, b) && !chord_allowed(state, loops, a, b)) chords.push_back({a, b});
    }
  }
  std::sort(chords.begin(), chords.end());
  chords.erase(std::unique(chords.begin(), chords.end()), chords.end());
  return chords;
}

/// The patch with a vertex in the middle of the edge (a, b).
CellPatch split_edge(const CellPatch& patch, int a, int b) {
  CellPatch split;
  for (const auto& t : patch) {
    int n = 0;
    while (n < 3 && !((t[n] == a && t[(n + 1) % 3] == b) || (t[n] == b && t[(n + 1) % 3] == a))) ++n;
    if (n == 3) {
      split.push_back(t);
      continue;
    }
    const int from = t[n], to = t[(n + 1) % 3], apex = t[(n + 2) % 3];
    split.push_back({from, kInnerVertex, apex});
    split.push_back({kInnerVertex, to, apex});
  }
  return split;
}

/// Takes from the pool what serves most of the geometries, again and again; leaves those that nothing serves.
void cover(const std::vector<TunnelCandidate>& pool, std::vector<const CellPoints*>& open,
           std::vector<TunnelCandidate>& chosen) {
  std::vector<const CellPoints*> hopeless;
  while (!open.empty()) {
    std::vector<const CellPoints*> jury;
    for (std::size_t n = 0; n < std::min(kJury, open.size()); ++n) {
      jury.push_back(open[n * open.size() / std::min(kJury, open.size())]);
    }
    const TunnelCandidate* best = nullptr;
    long most = 0;
    for (const TunnelCandidate& candidate : pool) {
      const long served =
          std::count_if(jury.begin(), jury.end(), [&](const CellPoints* g) { return !cuts_itself(candidate, *g); });
      if (served > most) most = served, best = &candidate;
    }
    if (best == nullptr) {  // nothing serves any of the jury
      hopeless.insert(hopeless.end(), jury.begin(), jury.end());
      std::erase_if(open, [&](const CellPoints* g) { return std::find(jury.begin(), jury.end(), g) != jury.end(); });
      continue;
    }
    chosen.push_back(*best);
    std::erase_if(open, [&](const CellPoints* g) { return !cuts_itself(*best, *g); });
  }
  open = std::move(hopeless);
}

/// After the chosen patches, those that differ from one of them by the depth of the vertex inside alone: they may serve
/// a geometry that was not among the samples.
void add_other_depths(const std::vector<TunnelCandidate>& pool, std::vector<TunnelCandidate>& chosen) {
  const auto is_chosen = [&](const TunnelCandidate& candidate, bool depth_too) {
    return std::any_of(chosen.begin(), chosen.end(), [&](const TunnelCandidate& other) {
      return other.triangles == candidate.triangles && (!depth_too || other.inner.depth == candidate.inner.depth);
    });
  };
  for (const TunnelCandidate& candidate : pool) {
    if (is_chosen(candidate, false) && !is_chosen(candidate, true)) chosen.push_back(candidate);
  }
}

/// Discs and annulus of a state in every way, whoever owns their chords.
std::vector<CellPatch> all_patches(const CellState& state, const StateWitnesses& witnesses, const CellLoops& loops) {
  const auto [p, q] = tunnel_loops(state, witnesses, loops);
  std::vector<CellPatch> patches = {{}};
  const auto join = [&](const auto& parts) {
    std::vector<CellPatch> joined;
    for (const CellPatch& patch : patches) {
      for (const CellPatch& part : parts) {
        joined.push_back(patch);
        joined.back().insert(joined.back().end(), part.begin(), part.end());
      }
    }
    patches = std::move(joined);
  };
  if (p >= 0) join(annuli(loops, loops.loops[p], loops.loops[q]));
  for (int n = 0; n < static_cast<int>(loops.loops.size()); ++n) {
    if (n != p && n != q) join(PolygonPatches(loops, loops.loops[n]).all());
  }
  return patches;
}

/// The patches that are proven right, by the area that they have over the witnesses.
std::vector<TunnelCandidate> without_fault(const CellState& state, const StateWitnesses& witnesses,
                                           const std::vector<CellPatch>& patches) {
  std::vector<std::pair<double, TunnelCandidate>> by_area;
  for (const CellPatch& patch : patches) {
    if (find_fault(state, patch).empty()) by_area.push_back({area_of(witnesses, patch), {patch, {}}});
  }
  std::stable_sort(by_area.begin(), by_area.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<TunnelCandidate> pool;
  for (auto& [area, candidate] : by_area) pool.push_back(std::move(candidate));
  return pool;
}

std::vector<TunnelCandidate> with_inner_vertex(const CellState& state, const CellLoops& loops,
                                               const std::vector<CellPatch>& patches) {
  std::vector<TunnelCandidate> candidates;
  for (const CellPatch& patch : patches) {
    const auto chords = forbidden_chords(state, loops, patch);
    if (chords.size() != 1) continue;
    const auto [a, b] = chords.front();
    TunnelCandidate candidate{.triangles = split_edge(patch, a, b), .inner = {}};
    if (!find_fault(state, candidate.triangles).empty()) continue;
    candidate.inner.face = static_cast<std::int8_t>(face_chord(a, b).face);
    candidate.inner.chord = {static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b)};
    for (const std::uint8_t depth : kDepths) {
      candidate.inner.depth = depth;
      candidates.push_back(candidate);
    }
  }
  return candidates;
}

}  // namespace

bool cuts_itself(const TunnelCandidate& candidate, const CellPoints& points) {
  std::vector<std::uint8_t> corners;
  for (const auto& t : candidate.triangles) {
    for (int vertex : t) corners.push_back(static_cast<std::uint8_t>(vertex));
  }
  if (!candidate.inner.has_inner_vertex()) return patch_cuts_itself(corners, points);
  CellPoints with_inner = points;
  for (int sheet = 0; sheet < 2; ++sheet) {
    with_inner[kInnerVertex] = inner_point(candidate.inner, points, sheet);
    if (patch_cuts_itself(corners, with_inner)) return true;
  }
  return false;
}

std::vector<TunnelCandidate> choose_candidates(const CellState& state, const StateWitnesses& witnesses,
                                               const std::vector<CellPoints>& geometries) {
  const CellLoops loops = trace_loops(state.above, state.joined_faces);
  const std::vector<CellPatch> patches = all_patches(state, witnesses, loops);
  std::vector<const CellPoints*> open;
  for (const CellPoints& points : geometries) open.push_back(&points);
  std::vector<TunnelCandidate> chosen;
  cover(without_fault(state, witnesses, patches), open, chosen);
  if (!open.empty()) {
    const auto pool = with_inner_vertex(state, loops, patches);
    cover(pool, open, chosen);
    add_other_depths(pool, chosen);
  }
  return chosen;
}

}  // namespace geosis::generator
