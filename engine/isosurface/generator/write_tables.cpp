#include "engine/isosurface/generator/write_tables.h"

#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <vector>

#include "engine/isosurface/cell.h"
#include "engine/isosurface/generator/cell_loops.h"
#include "engine/isosurface/mc33_tables.h"

namespace geosis::generator {
namespace {

using States = std::map<CellState, ProvenState>;

struct Tables {
  std::vector<Mc33Mask> masks;
  std::vector<Mc33State> states;
  std::vector<Mc33Tunnel> tunnels;
  std::vector<Mc33TunnelPatch> tunnel_patches;
  std::vector<int> corners;
};

Mc33Patch add_patch(const CellPatch& patch, Tables& tables) {
  const Mc33Patch entry{.first = static_cast<std::uint16_t>(tables.corners.size()),
                        .count = static_cast<std::uint8_t>(patch.size())};
  for (const auto& triangle : patch) tables.corners.insert(tables.corners.end(), triangle.begin(), triangle.end());
  return entry;
}

std::int16_t add_tunnel(CellState state, Tunnel tunnel, const States& states, Tables& tables) {
  state.tunnel = tunnel;
  const auto found = states.find(state);
  if (found == states.end()) return kNoTunnel;
  tables.tunnels.push_back({.first = static_cast<std::uint16_t>(tables.tunnel_patches.size()),
                            .count = static_cast<std::uint8_t>(found->second.patches.size())});
  for (const TunnelCandidate& candidate : found->second.patches) {
    Mc33TunnelPatch entry = candidate.inner;
    entry.patch = add_patch(candidate.triangles, tables);
    tables.tunnel_patches.push_back(entry);
  }
  return static_cast<std::int16_t>(tables.tunnels.size() - 1);
}

/// A state; an empty patch where no function takes it.
Mc33State make_state(const CellState& state, const States& states, Tables& tables) {
  Mc33State entry;
  if (const auto found = states.find(state); found != states.end()) {
    entry.patch = add_patch(found->second.patches.front().triangles, tables);
  }
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
  if (tables.corners.size() > 0xffff) {
    std::fprintf(stderr, "the triangles do not fit their 16-bit places\n");
    std::exit(1);
  }
  return tables;
}

void print_corners(const Tables& tables, std::ostream& out) {
  out << "const std::uint8_t kMc33Corners[] = {\n";
  for (std::size_t n = 0; n < tables.corners.size(); ++n) {
    out << (n % 36 == 0 ? "    " : "") << tables.corners[n] << ',' << (n % 36 == 35 ? "\n" : " ");
  }
  out << "};\n";
}

void print_states(const Tables& tables, std::ostream& out) {
  out << "const Mc33State kMc33States[] = {\n";
  for (const auto& state : tables.states) {
    out << "    {{" << state.patch.first << ", " << int{state.patch.count} << "}, " << state.tunnel_above << ", "
        << state.tunnel_below << ", {";
    for (int c = 0; c < cell::kCorners; ++c) out << (c ? ", " : "") << int{state.region[c]};
    out << "}},\n";
  }
  out << "};\n\n";
}

void print_tunnels(const Tables& tables, std::ostream& out) {
  out << "const Mc33Tunnel kMc33Tunnels[] = {\n";
  for (const auto& tunnel : tables.tunnels) out << "    {" << tunnel.first << ", " << int{tunnel.count} << "},\n";
  out << "};\n\nconst Mc33TunnelPatch kMc33TunnelPatches[] = {\n";
  for (const auto& entry : tables.tunnel_patches) {
    out << "    {{" << entry.patch.first << ", " << int{entry.patch.count} << "}, " << int{entry.face} << ", {"
        << int{entry.chord[0]} << ", " << int{entry.chord[1]} << "}, " << int{entry.depth} << "},\n";
  }
  out << "};\n\n";
}

}  // namespace

std::string tables_text(const std::map<CellState, ProvenState>& states) {
  const Tables tables = make_tables(states);
  std::ostringstream out;
  out << "// Written by engine/isosurface/generator: do not edit.\n"
      << "// " << states.size() << " states that a trilinear function can take, " << tables.tunnels.size()
      << " of them with a tunnel; docs/mc33-cases.md counts them.\n"
      << "#include \"engine/isosurface/mc33_tables.h\"\n\nnamespace geosis {\n\n// clang-format off\n"
      << "const std::array<Mc33Mask, 256> kMc33Masks = {{\n";
  for (const auto& mask : tables.masks)
    out << "    {" << mask.first_state << ", " << int{mask.ambiguous_faces} << "},\n";
  out << "}};\n\n";
  print_states(tables, out);
  print_tunnels(tables, out);
  print_corners(tables, out);
  out << "// clang-format on\n\n}  // namespace geosis\n";
  return out.str();
}

}  // namespace geosis::generator
