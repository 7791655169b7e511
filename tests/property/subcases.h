#pragma once

#include <array>
#include <vector>

#include "tests/support/random.h"
#include "tests/support/scalar_field.h"

namespace geosis::test {

/// A cell of one of Chernyaev's subcases at level 0: corner 4 di + 2 dj + dk. Case 0 has no surface and is left out.
struct Subcase {
  const char* name;
  std::array<float, 8> corner;
  int euler;  ///< of the surface in the cell, open: its discs; an annulus counts 0
};

const std::vector<Subcase>& subcases();

/// The cell under symmetry 0..47 of the cube, negated or not, in the middle of a cube of `nodes` nodes an axis (2: the
/// cell alone) filled with noise of the cell's magnitude.
ScalarField embedded(const Subcase& subcase, int symmetry, bool negated, int nodes, Random& random);

}  // namespace geosis::test
