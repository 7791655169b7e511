#include "tests/property/subcases.h"

#include <algorithm>
#include <cmath>

#include "tests/support/phantoms.h"

namespace geosis::test {

const std::vector<Subcase>& subcases() {
  static const std::vector<Subcase> kSubcases = {
      {"1", {7, -9, -4, -4, -7, -8, -5, -3}, 1},
      {"2", {8, 8, -5, -4, -8, -9, -3, -1}, 1},
      {"3.1", {-5, 1, 1, -6, -9, -2, -2, -1}, 2},
      {"3.2", {-12, 50, 33, -34, -1, -16, -21, -31}, 1},
      {"4.1.1", {-15, -1, -13, 20, 12, -20, -19, -12}, 2},
      {"4.1.2", {-188, -1, -3, 164, 300, -53, -118, -52}, 0},
      {"5", {7, 6, 1, -3, -4, -8, -9, -1}, 1},
      {"6.1.1", {5, -7, -3, 3, 9, -5, -8, -1}, 2},
      {"6.1.2", {20, -99, -13, 46, 64, -39, -1, -1}, 0},
      {"6.2", {18, -19, -1, 20, 18, -10, -10, -16}, 1},
      {"7.1", {-9, 1, 6, -8, 8, -3, -6, -7}, 3},
      {"7.2", {-3, 4, 8, -3, 1, -2, -5, -9}, 2},
      {"7.3", {-1, 4, 2, -6, 2, -3, -8, -9}, 1},
      {"7.4.1", {-3, 5, 8, -5, 9, -4, -1, -6}, 2},
      {"7.4.2", {-7, 7, 14, -6, 4, -2, -1, -20}, 0},
      {"8", {8, 6, 2, 2, -9, -8, -8, -3}, 1},
      {"9", {32, 1, 50, -41, 29, -48, -10, -28}, 1},
      {"10.1.1", {-77, -77, 99, 52, 1, 5, -60, -60}, 2},
      {"10.1.2", {-73, -178, 5, 300, 221, 1, -37, -210}, 0},
      {"10.2", {-1, -3, 4, 1, 7, 8, -9, -9}, 1},
      {"11", {9, 1, -9, 6, 1, -8, -2, -1}, 1},
      {"12.1.1", {-3, 1, 5, 7, 1, -9, -9, -6}, 2},
      {"12.1.2", {-7, 7, 3, 9, 5, -6, -3, -1}, 0},
      {"12.2", {-3, 9, 6, 1, 1, -2, -6, -6}, 1},
      {"12.3", {-1, 2, 6, 6, 3, -9, -6, -1}, 1},
      {"13.1", {4, -7, -8, 3, -9, 2, 7, -8}, 4},
      {"13.2", {10, -3, -9, 7, -7, 1, 2, -20}, 3},
      {"13.3", {15, -7, -20, 16, -6, 6, 6, -16}, 2},
      {"13.4", {8, -5, -2, 2, -7, 7, 6, -9}, 1},
      {"13.5.1", {11390, -24549, -13393, 4, -1199, 12832, 100000, -632}, 3},
      {"13.5.2", {8, -8, -9, 8, -1, 7, 7, -8}, 1},
      {"14", {9, -9, 1, 6, 1, -2, -8, -1}, 1},
  };
  return kSubcases;
}

ScalarField embedded(const Subcase& subcase, int symmetry, bool negated, int nodes, Random& random) {
  constexpr std::array<std::array<int, 3>, 6> kOrders = {
      {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
  const auto& order = kOrders[symmetry / 8];
  float largest = 0;
  for (float value : subcase.corner) largest = std::max(largest, std::fabs(value));
  ScalarField field = uniform_noise({nodes, nodes, nodes}, random, -largest, largest);
  const int first = nodes / 2 - 1;
  for (int c = 0; c < 8; ++c) {
    GridIndex node{first, first, first};
    for (int axis = 0; axis < 3; ++axis) node[order[axis]] += ((c >> (2 - axis)) ^ (symmetry >> axis)) & 1;
    field.at(node) = negated ? -subcase.corner[c] : subcase.corner[c];
  }
  return field;
}

}  // namespace geosis::test
