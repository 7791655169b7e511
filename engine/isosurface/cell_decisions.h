#pragma once

#include <array>
#include <cstdint>

namespace geosis {

/// The eight corner values of a cell and the level that cuts them, as exact doubles.
///
/// Corners are "above" or "below" the level. A corner exactly on it goes to the side that the sheet's perturbation
/// says: {f = low} is taken at low - eps, {f = high} at high + eps for an infinitely small eps, so that the closed body
/// {low <= f <= high} keeps what touches its ends. Every decision below is that of the perturbed level.
struct CellValues {
  std::array<double, 8> value{};  ///< corner values; float32 samples, or g formed once in double
  double level = 0;
  bool ties_above = true;  ///< true at low - eps (a tie counts as above), false at high + eps
};

/// Whether the two corners above the level are joined across an ambiguous face (else the two below are).
///
/// source   Nielson & Hamann 1991 (asymptotic decider); exact for all finite float32 samples.
bool above_joined_on_face(const CellValues& cell, std::uint8_t above, int face);

/// The decisions of all ambiguous faces, as bits.
std::uint8_t joined_faces(const CellValues& cell, std::uint8_t above, std::uint8_t ambiguous_faces);

/// Two corners of equal sign that the cell's interior joins although no face does, or joined = false.
struct InteriorJoint {
  bool joined = false;
  bool above = false;         ///< sign of the two corners
  int first = 0, second = 0;  ///< corners
};

/// The slice between the bottom and top face (along k) where the bilinear slices change most, and what it joins.
///
/// The caller compares the two corners' regions: only corners of different regions make a tunnel.
/// source   Chernyaev 1995, section on the interior test, in the form of a saddle of A C - B D.
InteriorJoint interior_joint(const CellValues& cell, std::uint8_t above);

}  // namespace geosis
