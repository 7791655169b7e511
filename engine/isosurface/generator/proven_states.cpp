#include "engine/isosurface/generator/proven_states.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "engine/isosurface/generator/cell_geometries.h"

namespace geosis::generator {
namespace {

std::uint64_t seed_of(const CellState& state, int purpose) {
  return static_cast<std::uint64_t>(state.above) << 16 | static_cast<std::uint64_t>(state.joined_faces) << 8 |
         static_cast<std::uint64_t>(state.tunnel) << 4 | static_cast<std::uint64_t>(purpose);
}

[[noreturn]] void fail(const CellState& state, const std::string& fault) {
  std::fprintf(stderr, "mask %d, joined faces %d, tunnel %d: %s\n", state.above, state.joined_faces,
               static_cast<int>(state.tunnel), fault.c_str());
  std::exit(1);
}

std::vector<TunnelCandidate> patches_of(const CellState& state, const StateWitnesses& witnesses) {
  const auto geometries =
      sample_geometries(state, witnesses, kToChoose[state.tunnel != Tunnel::none], seed_of(state, 1));
  if (state.tunnel != Tunnel::none) return choose_candidates(state, witnesses, geometries);
  const TunnelCandidate smallest{fill_discs(state, witnesses), {}};
  const bool cuts = std::any_of(geometries.begin(), geometries.end(),
                                [&](const CellPoints& points) { return cuts_itself(smallest, points); });
  return cuts ? choose_candidates(state, witnesses, geometries) : std::vector{smallest};
}

void check_geometries(const CellState& state, const StateWitnesses& witnesses, ProvenState& proven) {
  const int count = kToCheck[state.tunnel != Tunnel::none];
  for (const CellPoints& points : sample_geometries(state, witnesses, count, seed_of(state, 2))) {
    ++proven.geometries;
    std::size_t serves = 0;
    while (serves < proven.patches.size() && cuts_itself(proven.patches[serves], points)) ++serves;
    proven.first_cuts += serves != 0;
    if (serves == proven.patches.size()) {
      ++proven.all_cut;
    } else {
      proven.inner_serves += proven.patches[serves].inner.has_inner_vertex();
    }
  }
}

}  // namespace

std::map<CellState, ProvenState> prove_states() {
  std::map<CellState, ProvenState> states;
  for (const auto& [state, witnesses] : enumerate_states()) {
    ProvenState proven{.patches = patches_of(state, witnesses)};
    if (proven.patches.empty()) fail(state, "no patch can fill it");
    for (const TunnelCandidate& patch : proven.patches) {
      if (const std::string fault = find_fault(state, patch.triangles); !fault.empty()) fail(state, fault);
    }
    check_geometries(state, witnesses, proven);
    if (state.tunnel == Tunnel::none && proven.all_cut > 0) fail(state, "its discs cut themselves");
    states.emplace(state, std::move(proven));
  }
  return states;
}

}  // namespace geosis::generator
