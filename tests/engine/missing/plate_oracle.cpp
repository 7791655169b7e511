#include "tests/engine/missing/plate_oracle.h"

#include <algorithm>
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

/// What the solver is asked to find: wanted nodes, numbered, and the gaps that they belong to.
class Unknowns {
 public:
  Unknowns(const GapBox& gap, const std::vector<Term>& terms) : gap_(gap) {
    for (std::size_t place = 0; place < gap.state.size(); ++place)
      if (gap.state[place] == NodeState::wanted) number_.emplace(place, number_.size());
    label(terms);
    decide_which_are_scattered();
  }

  std::size_t count() const { return number_.size(); }
  /// -1 for nodes that are not wanted.
  int number(const Node& node) const {
    const auto found = is_inside(gap_, node) ? number_.find(place_of(gap_, node)) : number_.end();
    return found == number_.end() ? -1 : static_cast<int>(found->second);
  }
  bool is_scattered(int unknown) const { return scattered_.at(label_[static_cast<std::size_t>(unknown)]); }

 private:
  /// The smallest number of each gap, by handing it on until nothing changes.
  void label(const std::vector<Term>& terms) {
    label_.resize(count());
    for (std::size_t n = 0; n < count(); ++n) label_[n] = n;
    for (bool changed = true; changed;) {
      changed = false;
      for (const Term& term : terms) {
        std::size_t smallest = count();
        for (const auto& [node, factor] : term.factors)
          if (number(node) >= 0) smallest = std::min(smallest, label_[static_cast<std::size_t>(number(node))]);
        for (const auto& [node, factor] : term.factors) {
          if (number(node) < 0 || label_[static_cast<std::size_t>(number(node))] == smallest) continue;
          label_[static_cast<std::size_t>(number(node))] = smallest;
          changed = true;
        }
      }
    }
  }

  void decide_which_are_scattered() {
    std::map<std::size_t, std::pair<int, int>> nodes_and_enclosed;
    const GridShape shape = gap_.samples.shape;
    for (int i = 0; i < shape.inlines; ++i)
      for (int j = 0; j < shape.crosslines; ++j)
        for (int k = 0; k < shape.samples; ++k) {
          const Node node{i, j, k};
          if (number(node) < 0) continue;
          auto& [nodes, enclosed] = nodes_and_enclosed[label_[static_cast<std::size_t>(number(node))]];
          ++nodes;
          bool between = false;
          for (int axis = 0; axis < 3; ++axis)
            between = between || (number(moved(node, axis, -1)) >= 0 && number(moved(node, axis, 1)) >= 0);
          enclosed += between;
        }
    for (const auto& [gap, tally] : nodes_and_enclosed) scattered_[gap] = tally.second * 4 < tally.first;
  }

  const GapBox& gap_;
  std::map<std::size_t, std::size_t> number_;  // by place
  std::vector<std::size_t> label_;
  std::map<std::size_t, bool> scattered_;  // by label
};

}  // namespace

std::vector<double> least_bending(const GapBox& gap, Vec3d weights) {
  const std::vector<Term> terms = all_terms(gap);
  const Unknowns unknowns(gap, terms);
  const std::size_t n = unknowns.count();
  std::vector<double> M(n * n, 0.0), b(n, 0.0);
  for (const Term& term : terms) {
    bool scattered = false, complete = true;
    for (const auto& [node, factor] : term.factors) {
      scattered = scattered || (unknowns.number(node) >= 0 && unknowns.is_scattered(unknowns.number(node)));
      complete = complete && gap.state[place_of(gap, node)] != NodeState::absent;
    }
    if (!complete) continue;
    const double c = scattered ? 1 : weights[term.axis_a] * weights[term.axis_b];
    for (const auto& [row, row_factor] : term.factors) {
      if (unknowns.number(row) < 0) continue;
      const auto r = static_cast<std::size_t>(unknowns.number(row));
      for (const auto& [column, column_factor] : term.factors) {
        const double product = c * row_factor * column_factor;
        if (unknowns.number(column) >= 0)
          M[r * n + static_cast<std::size_t>(unknowns.number(column))] += product;
        else
          b[r] -= product * static_cast<double>(gap.samples.value[place_of(gap, column)]);
      }
    }
  }
  return cholesky_solve(std::move(M), std::move(b));
}

}  // namespace geosis::test
