#include "tests/engine/missing/plate_oracle.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

namespace geosis::test {
namespace {

using Node = std::array<int, 3>;

struct Term {
  int axis_a = 0, axis_b = 0;
  std::vector<std::pair<Node, double>> factors;
};

Node moved(Node node, int axis, int steps) {
  node[axis] += steps;
  return node;
}

bool is_inside(const GapBox& gap, const Node& node) {
  for (int axis = 0; axis < 3; ++axis)
    if (node[axis] < 0 || node[axis] >= gap.samples.shape[axis]) return false;
  return true;
}

std::size_t place_of(const GapBox& gap, const Node& node) {
  return gap.samples.at(node[0], node[1], node[2]);
}

/// Every term of the energy that lies in the box.
std::vector<Term> all_terms(const GapBox& gap) {
  std::vector<Term> terms;
  const GridShape shape = gap.samples.shape;
  const auto keep = [&](Term term) {
    for (const auto& [node, factor] : term.factors)
      if (!is_inside(gap, node)) return;
    terms.push_back(std::move(term));
  };
  for (int i = 0; i < shape.inlines; ++i)
    for (int j = 0; j < shape.crosslines; ++j)
      for (int k = 0; k < shape.samples; ++k)
        for (int a = 0; a < 3; ++a) {
          const Node x{i, j, k};
          keep({a, a, {{moved(x, a, -1), 1}, {x, -2}, {moved(x, a, 1), 1}}});
          for (int b = a + 1; b < 3; ++b) {
            const double root = std::sqrt(2.0);
            keep({a,
                  b,
                  {{x, root}, {moved(x, a, 1), -root}, {moved(x, b, 1), -root}, {moved(moved(x, a, 1), b, 1), root}}});
          }
        }
  return terms;
}

/// x of M x = b for a symmetric positive definite M, row-major.
std::vector<double> cholesky_solve(std::vector<double> M, std::vector<double> b) {
  const std::size_t n = b.size();
  for (std::size_t c = 0; c < n; ++c) {
    for (std::size_t k = 0; k < c; ++k) M[c * n + c] -= M[c * n + k] * M[c * n + k];
    M[c * n + c] = std::sqrt(M[c * n + c]);
    for (std::size_t r = c + 1; r < n; ++r) {
      for (std::size_t k = 0; k < c; ++k) M[r * n + c] -= M[r * n + k] * M[c * n + k];
      M[r * n + c] /= M[c * n + c];
    }
  }
  for (std::size_t r = 0; r < n; ++r) {
    for (std::size_t k = 0; k < r; ++k) b[r] -= M[r * n + k] * b[k];
    b[r] /= M[r * n + r];
  }
  for (std::size_t r = n; r-- > 0;) {
    for (std::size_t k = r + 1; k < n; ++k) b[r] -= M[k * n + r] * b[k];
    b[r] /= M[r * n + r];
  }
  return b;
}

}  // namespace

std::vector<double> least_bending(const GapBox& gap, Vec3d weights) {
  std::map<std::size_t, std::size_t> unknown;  // place -> number
  for (std::size_t place = 0; place < gap.state.size(); ++place)
    if (gap.state[place] == NodeState::wanted) unknown.emplace(place, unknown.size());
  const std::size_t n = unknown.size();
  const std::vector<Term> terms = all_terms(gap);

  std::vector<int> partners(n, 0);  // other unknowns in a node's stencils
  for (const Term& term : terms) {
    std::vector<std::size_t> members;
    for (const auto& [node, factor] : term.factors)
      if (unknown.count(place_of(gap, node)) != 0) members.push_back(unknown[place_of(gap, node)]);
    for (const std::size_t member : members) partners[member] += static_cast<int>(members.size()) - 1;
  }

  std::vector<double> M(n * n, 0.0), b(n, 0.0);
  for (const Term& term : terms) {
    bool alone = false, complete = true;
    for (const auto& [node, factor] : term.factors) {
      const auto found = unknown.find(place_of(gap, node));
      alone = alone || (found != unknown.end() && partners[found->second] == 0);
      complete = complete && gap.state[place_of(gap, node)] != NodeState::absent;
    }
    if (!complete) continue;
    const double c = alone ? 1 : weights[term.axis_a] * weights[term.axis_b];
    for (const auto& [row, row_factor] : term.factors) {
      const auto r = unknown.find(place_of(gap, row));
      if (r == unknown.end()) continue;
      for (const auto& [column, column_factor] : term.factors) {
        const auto x = unknown.find(place_of(gap, column));
        const double product = c * row_factor * column_factor;
        if (x != unknown.end())
          M[r->second * n + x->second] += product;
        else
          b[r->second] -= product * static_cast<double>(gap.samples.value[place_of(gap, column)]);
      }
    }
  }
  return cholesky_solve(std::move(M), std::move(b));
}

}  // namespace geosis::test
