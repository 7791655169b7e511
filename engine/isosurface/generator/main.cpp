// Writes engine/isosurface/mc33_tables.cpp to standard output: enumerates every state of a cell, triangulates and
// proves each, and lays them out for the mesher. A test compares the output with the committed file.
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "engine/isosurface/cell.h"
#include "engine/isosurface/generator/cell_loops.h"
#include "engine/isosurface/generator/cell_patches.h"
#include "engine/isosurface/generator/cell_states.h"
#include "engine/isosurface/mc33_tables.h"

namespace geosis::generator {
namespace {

struct Tables {
  std::vector<Mc33Mask> masks;
  std::vector<Mc33State> states;
  std::vector<Mc33Patch> tunnels;
  std::vector<int> corners;
  int realised = 0, with_tunnel = 0;
};

using States = std::map<CellState, StateWitnesses>;

/// Appends the proven patch of a state; an empty one for states that no function takes.
Mc33Patch add_patch(const CellState& state, const States& states, Tables& tables) {
  const auto found = states.find(state);
  if (found == states.end()) return {};
  const CellPatch patch = fill_loops(state, found->second);
  if (const std::string fault = find_fault(state, patch); !fault.empty()) {
    std::fprintf(stderr, "mask %d, joined faces %d, tunnel %d: %s\n", state.above, state.joined_faces,
                 static_cast<int>(state.tunnel), fault.c_str());
    std::exit(1);
  }
  const Mc33Patch entry{.first = static_cast<std::uint16_t>(tables.corners.size()),
                        .count = static_cast<std::uint8_t>(patch.size())};
  for (const auto& triangle : patch) tables.corners.insert(tables.corners.end(), triangle.begin(), triangle.end());
  ++tables.realised;
  tables.with_tunnel += state.tunnel != Tunnel::none;
  return entry;
}

std::int16_t add_tunnel(CellState state, Tunnel tunnel, const States& states, Tables& tables) {
  state.tunnel = tunnel;
  if (!states.contains(state)) return kNoTunnel;
  tables.tunnels.push_back(add_patch(state, states, tables));
  return static_cast<std::int16_t>(tables.tunnels.size() - 1);
}

Mc33State make_state(const CellState& state, const States& states, Tables& tables) {
  Mc33State entry;
  entry.patch = add_patch(state, states, tables);
  entry.tunnel_above = add_tunnel(state, Tunnel::above, states, tables);
  entry.tunnel_below = add_tunnel(state, Tunnel::below, states, tables);
  const auto region = trace_loops(state.above, state.joined_faces).region;
  for (int c = 0; c < cell::kCorners; ++c) entry.region[c] = static_cast<std::uint8_t>(region[c]);
  return entry;
}

Tables make_tables(const States& states) {
  Tables tables;
  for (int mask = 0; mask < 256; ++mask) {
    const auto above = static_cast<std::uint8_t>(mask);
    const std::uint8_t ambiguous = cell::ambiguous_faces(above);
    tables.masks.push_back(
        {.first_state = static_cast<std::uint16_t>(tables.states.size()), .ambiguous_faces = ambiguous});
    for (unsigned joined = 0; joined < 64; ++joined) {
      if ((joined & ~unsigned{ambiguous}) != 0) continue;  // ascending subsets of a bit set: the order of pack_faces
      tables.states.push_back(
          make_state({.above = above, .joined_faces = static_cast<std::uint8_t>(joined)}, states, tables));
    }
  }
  return tables;
}

void print_corners(const Tables& tables) {
  std::printf("const std::uint8_t kMc33Corners[] = {\n");
  for (std::size_t n = 0; n < tables.corners.size(); ++n) {
    std::printf("%s%d,%s", n % 36 == 0 ? "    " : "", tables.corners[n], n % 36 == 35 ? "\n" : " ");
  }
  std::printf("};\n");
}

void print_tables(const Tables& tables) {
  std::printf("// Written by engine/isosurface/generator: do not edit.\n");
  std::printf(
      "// %d states that a trilinear function can take, %d of them with a tunnel; %zu triangles, each patch proven.\n",
      tables.realised, tables.with_tunnel, tables.corners.size() / 3);
  std::printf("#include \"engine/isosurface/mc33_tables.h\"\n\nnamespace geosis {\n\n// clang-format off\n");
  std::printf("const std::array<Mc33Mask, 256> kMc33Masks = {{\n");
  for (const auto& mask : tables.masks) std::printf("    {%d, %d},\n", mask.first_state, mask.ambiguous_faces);
  std::printf("}};\n\nconst Mc33State kMc33States[] = {\n");
  for (const auto& state : tables.states) {
    std::printf("    {{%d, %d}, %d, %d, {", state.patch.first, state.patch.count, state.tunnel_above,
                state.tunnel_below);
    for (int c = 0; c < cell::kCorners; ++c) std::printf("%s%d", c ? ", " : "", state.region[c]);
    std::printf("}},\n");
  }
  std::printf("};\n\nconst Mc33Patch kMc33Tunnels[] = {\n");
  for (const auto& patch : tables.tunnels) std::printf("    {%d, %d},\n", patch.first, patch.count);
  std::printf("};\n\n");
  print_corners(tables);
  std::printf("// clang-format on\n\n}  // namespace geosis\n");
}

}  // namespace
}  // namespace geosis::generator

int main() {
  geosis::generator::print_tables(geosis::generator::make_tables(geosis::generator::enumerate_states()));
}
