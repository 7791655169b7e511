#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/vec3.h"
#include "engine/missing/gaps/gap_box.h"
#include "engine/volume/grid.h"

namespace geosis {

/// One multigrid V-cycle for L u = r, L u(x) = sum_a c_a (2 u(x) - u(x-e_a) - u(x+e_a)) over the wanted nodes of a box:
/// u = 0 at known nodes, no flow to absent ones. A symmetric positive operator from r to u.
///
/// Two polynomially damped Jacobi sweeps before and after; a coarse node is every second one on the axes that are
/// coarsened, which are those of strong coupling first; linear prolongation, restriction its transpose. All arrays are
/// dense over the box, whose outermost layer holds no wanted node.
class PoissonCycle {
 public:
  PoissonCycle(GridShape shape, std::vector<NodeState> state, Vec3d weights, const Progress& progress);

  /// right, u, spare  (nodes of the box); right is zero at nodes that are not wanted, u comes back so; the first and
  ///                  the last layer of nodes are zero and stay so. Incomplete when cancelled.
  void solve(std::span<const float> right, std::span<float> u, std::span<float> spare);

  /// One over the diagonal of L; zero at nodes that are not wanted, or have no neighbour that is not absent.
  std::span<const float> inverse_diagonal() const { return levels_[0].inverse; }

 private:
  struct Level {
    GridShape shape;
    Vec3<float> weight;
    std::array<bool, 3> coarsened{};  // on the way to the next level
    std::vector<NodeState> state;     // only while the levels are made
    std::vector<float> diagonal, inverse;
    std::vector<float> right, u, spare;  // of all levels but the first, whose arrays are the caller's

    std::size_t row() const { return static_cast<std::size_t>(shape.samples); }
    std::size_t plane() const { return row() * static_cast<std::size_t>(shape.crosslines); }
    /// Nodes whose six neighbours are in the arrays: [begin, end).
    std::size_t begin() const { return plane() + row() + 1; }
    std::size_t end() const { return plane() * static_cast<std::size_t>(shape.inlines) - begin(); }
  };

  static bool choose_axes(Level& level);
  static Level coarser(const Level& fine);
  static void finish(Level& level);
  static void sweep(const Level& level, const float* right, const float* u, float damping, float* next);
  static void residual(const Level& level, const float* right, const float* u, float* left);
  static void restrict_to(Level& coarse, const Level& fine, const float* left);
  static void prolong(const Level& coarse, const Level& fine, float* u);
  void cycle(std::size_t number, const float* right, float* u, float* spare);
  void solve_coarsest(const Level& level, const float* right, float* u, float* spare);

  const Progress& progress_;
  std::vector<Level> levels_;
};

}  // namespace geosis
