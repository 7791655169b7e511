#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/missing/gaps/gap_box.h"

namespace geosis::test {

/// Dense Gaussian elimination with pivoting: the solution of a x = b.
inline std::vector<double> solve(std::vector<std::vector<double>> a, std::vector<double> b) {
  const std::size_t n = b.size();
  for (std::size_t c = 0; c < n; ++c) {
    std::size_t pivot = c;
    for (std::size_t r = c + 1; r < n; ++r) {
      if (std::abs(a[r][c]) > std::abs(a[pivot][c])) pivot = r;
    }
    std::swap(a[c], a[pivot]);
    std::swap(b[c], b[pivot]);
    for (std::size_t r = c + 1; r < n; ++r) {
      const double factor = a[r][c] / a[c][c];
      for (std::size_t k = c; k < n; ++k) a[r][k] -= factor * a[c][k];
      b[r] -= factor * b[c];
    }
  }
  for (std::size_t c = n; c-- > 0;) {
    for (std::size_t k = c + 1; k < n; ++k) b[c] -= a[c][k] * b[k];
    b[c] /= a[c][c];
  }
  return b;
}

/// The thin plate on the plain grid, minimised by dense elimination: no dips, no iteration.
class DensePlate {
 public:
  DensePlate(const GapBox& gap, const Vec3d& steps) : gap_(gap), steps_(steps), unknown_(gap.state.size(), -1) {
    for (std::size_t n = 0; n < gap.state.size(); ++n) {
      if (gap.state[n] == NodeState::wanted) unknown_[n] = count_++;
    }
    matrix_.assign(static_cast<std::size_t>(count_), std::vector<double>(static_cast<std::size_t>(count_), 0.0));
    right_.assign(static_cast<std::size_t>(count_), 0.0);
    add_all();
  }

  /// The wanted values, in the order of the nodes.
  std::vector<double> fill() const { return solve(matrix_, right_); }

  /// Half the energy's gradient at the wanted nodes.
  std::vector<double> gradient(const std::vector<double>& wanted) const {
    std::vector<double> result = right_;
    for (std::size_t r = 0; r < result.size(); ++r) {
      result[r] = -right_[r];
      for (std::size_t c = 0; c < result.size(); ++c) result[r] += matrix_[r][c] * wanted[c];
    }
    return result;
  }

 private:
  void add_all() {
    const double least = std::min({steps_.x, steps_.y, steps_.z});
    for (int a = 0; a < 3; ++a) {
      for (int b = a; b < 3; ++b) {
        const double weight = (a == b ? 1 : 2) * std::pow(least / steps_[a], 2) * std::pow(least / steps_[b], 2);
        add_differences(a, b, weight);
      }
    }
  }

  struct Part {
    GridIndex node;
    double factor;
  };

  void add_differences(int a, int b, double weight) {
    const GridShape shape = gap_.samples.shape;
    for (int i = 0; i < shape.inlines; ++i) {
      for (int j = 0; j < shape.crosslines; ++j) {
        for (int k = 0; k < shape.samples; ++k) {
          const GridIndex x = {i, j, k};
          GridIndex before = x, after = x, other = x, both = x;
          ++after[a];
          --before[a];
          ++other[b];
          both = after;
          ++both[b];
          add(a == b ? std::vector<Part>{{before, 1}, {x, -2}, {after, 1}}
                     : std::vector<Part>{{x, 1}, {after, -1}, {other, -1}, {both, 1}},
              weight);
        }
      }
    }
  }

  void add(const std::vector<Part>& parts, double weight) {
    for (const Part& part : parts) {
      for (int axis = 0; axis < 3; ++axis) {
        if (part.node[axis] < 0 || part.node[axis] >= gap_.samples.shape[axis]) return;
      }
      if (gap_.state[place(part)] == NodeState::absent) return;
    }
    for (const Part& row : parts) {
      if (unknown_[place(row)] < 0) continue;
      const auto r = static_cast<std::size_t>(unknown_[place(row)]);
      for (const Part& column : parts) {
        const double product = weight * row.factor * column.factor;
        const int c = unknown_[place(column)];
        if (c >= 0) matrix_[r][static_cast<std::size_t>(c)] += product;
        if (c < 0) right_[r] -= product * gap_.samples.value[place(column)];
      }
    }
  }

  std::size_t place(const Part& part) const { return gap_.samples.at(part.node.i, part.node.j, part.node.k); }

  const GapBox& gap_;
  Vec3d steps_;
  std::vector<int> unknown_;
  int count_ = 0;
  std::vector<std::vector<double>> matrix_;
  std::vector<double> right_;
};

}  // namespace geosis::test
