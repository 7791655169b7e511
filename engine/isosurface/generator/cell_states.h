#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <map>
#include <vector>

namespace geosis::generator {

enum class Tunnel : std::uint8_t { none, above, below };

/// How the level of a trilinear function can lie in a cell.
struct CellState {
  std::uint8_t above = 0;         ///< sign mask
  std::uint8_t joined_faces = 0;  ///< decisions of the ambiguous faces
  Tunnel tunnel = Tunnel::none;

  auto operator<=>(const CellState&) const = default;
};

using Field = std::array<double, 8>;

/// The state of one function at level 0.
CellState classify(const Field& field);

struct StateWitnesses {
  std::vector<Field> fields;   ///< trilinear functions (level 0) that realise the state
  std::array<int, 2> joint{};  ///< regions that its tunnel joins
};

/// Every state that a trilinear function can take, with witnesses: seeded random functions of each sign pattern, and
/// their images under the 48 symmetries of the cube and the change of sign. The result is closed under these.
std::map<CellState, StateWitnesses> enumerate_states();

}  // namespace geosis::generator
