#pragma once

#include <array>
#include <cstdint>

namespace geosis {

/// Triangles of one cell: `count` triples in kMc33Corners, from entry `first` on. Each entry is a cell edge 0..11, for
/// the vertex on it, or kInnerVertex; seen from the side below the level, triangles are counter-clockwise.
struct Mc33Patch {
  std::uint16_t first = 0;
  std::uint8_t count = 0;
};

inline constexpr std::uint8_t kInnerVertex = 12;

/// One way to fill a state with a tunnel. Few have a vertex inside the cell: it splits a chord that lies in a face and
/// that the cell may not draw, and lies `depth` lattice steps (or one more) off the face.
struct Mc33TunnelPatch {
  Mc33Patch patch;
  std::int8_t face = -1;                ///< -1: no vertex inside
  std::array<std::uint8_t, 2> chord{};  ///< cell edges that the chord joins
  std::uint8_t depth = 0;

  constexpr bool has_inner_vertex() const { return face >= 0; }
};

/// The ways to fill a state with a tunnel, by preference: `count` entries of kMc33TunnelPatches. Where the crossings
/// lie decides which of them do not cut themselves (patch_geometry.h).
struct Mc33Tunnel {
  std::uint16_t first = 0;
  std::uint8_t count = 0;
};

inline constexpr std::int16_t kNoTunnel = -1;

/// One way in which the level can cross the cell's surface: a sign mask and the decisions of its ambiguous faces.
struct Mc33State {
  Mc33Patch patch;                        ///< without a tunnel
  std::int16_t tunnel_above = kNoTunnel;  ///< entry of kMc33Tunnels when the interior joins two regions above the level
  std::int16_t tunnel_below = kNoTunnel;  ///< the same for two regions below
  std::array<std::uint8_t, 8> region{};   ///< corner -> its region; corners joined along edges or faces share one
};

/// The sign masks: bit c set = corner c above the level.
struct Mc33Mask {
  std::uint16_t first_state = 0;  ///< its states follow, by the joined faces' bits packed together
  std::uint8_t ambiguous_faces = 0;
};

// Written by generator/ (target geosis_generate_mc33); a test writes them again and compares.
extern const std::array<Mc33Mask, 256> kMc33Masks;
extern const Mc33State kMc33States[];
extern const Mc33Tunnel kMc33Tunnels[];
extern const Mc33TunnelPatch kMc33TunnelPatches[];
extern const std::uint8_t kMc33Corners[];

/// The joined faces' bits, packed to the ambiguous faces' places: bit n belongs to the n-th ambiguous face.
constexpr unsigned pack_faces(unsigned joined, unsigned ambiguous) {
  unsigned packed = 0, place = 0;
  for (unsigned face = 0; face < 6; ++face) {
    if ((ambiguous >> face) & 1) packed |= ((joined >> face) & 1) << place++;
  }
  return packed;
}

}  // namespace geosis
