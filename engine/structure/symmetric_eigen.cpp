#include "engine/structure/symmetric_eigen.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace geosis {
namespace {

constexpr int kSweeps = 12;  // each more than squares what is left off the diagonal: five are enough for doubles

using Matrix = std::array<std::array<double, 3>, 3>;

/// Rotates axes p and q so that a[p][q] vanishes; v collects the rotations in its columns.
void rotate(Matrix& a, Matrix& v, std::size_t p, std::size_t q) {
  if (a[p][q] == 0) return;
  const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
  const double root = std::sqrt(theta * theta + 1);
  const double t = std::isfinite(root) ? (theta < 0 ? -1 : 1) / (std::abs(theta) + root) : 0;
  const double c = 1 / std::sqrt(t * t + 1), s = t * c;
  for (std::size_t r = 0; r < 3; ++r) {
    const double x = a[r][p], y = a[r][q];
    a[r][p] = c * x - s * y;
    a[r][q] = s * x + c * y;
  }
  for (std::size_t r = 0; r < 3; ++r) {
    const double x = a[p][r], y = a[q][r];
    a[p][r] = c * x - s * y;
    a[q][r] = s * x + c * y;
  }
  a[p][q] = a[q][p] = 0;
  for (std::size_t r = 0; r < 3; ++r) {
    const double x = v[r][p], y = v[r][q];
    v[r][p] = c * x - s * y;
    v[r][q] = s * x + c * y;
  }
}

}  // namespace

SymmetricEigen eigen_of(const SymmetricMatrix& m) {
  Matrix a = {{{m.xx, m.xy, m.xz}, {m.xy, m.yy, m.yz}, {m.xz, m.yz, m.zz}}};
  Matrix v = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    const double off = std::abs(a[0][1]) + std::abs(a[0][2]) + std::abs(a[1][2]);
    if (off <= 1e-15 * (std::abs(a[0][0]) + std::abs(a[1][1]) + std::abs(a[2][2]))) break;
    rotate(a, v, 0, 1);
    rotate(a, v, 0, 2);
    rotate(a, v, 1, 2);
  }
  std::size_t main = 0;
  for (std::size_t n = 1; n < 3; ++n) {
    if (a[n][n] > a[main][main]) main = n;
  }
  std::array<double, 3> values = {a[0][0], a[1][1], a[2][2]};
  std::sort(values.begin(), values.end());
  return {{values[2], values[1], values[0]}, {v[0][main], v[1][main], v[2][main]}};
}

}  // namespace geosis
