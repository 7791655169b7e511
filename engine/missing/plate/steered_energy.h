#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/missing/gaps/gap_box.h"
#include "engine/missing/plate/steered_paths.h"
#include "engine/missing/plate/trace_terms.h"

namespace geosis {

/// The bending energy of the plate whose lateral neighbours lie along the reflectors, as a quadratic form of the box's
/// samples. Its terms are the six second differences of each node; those count that lie in the box, touch a wanted node
/// and no absent one. Samples between the nodes of a trace come from the cubic through four.
///
/// Arrays have the box's nodes, sample fastest, and kSlack more; all finite.
class SteeredEnergy {
 public:
  static constexpr std::size_t kSlack = 4;  ///< a cubic's weight of zero may reach over the end

  /// Keeps references to state and paths.
  SteeredEnergy(std::span<const NodeState> state, const SteeredPaths& paths, const Vec3d& step_lengths);

  /// Half the gradient of the energy at x, on wanted nodes; zero elsewhere.
  /// cost: about 60 ns a node with a term
  void gradient(std::span<const float> x, std::span<float> result) const;
  /// About the same's derivative by each node alone; zero on nodes that no term touches.
  void diagonal(std::span<float> result) const;

 private:
  struct Range {
    std::int32_t first = 0, end = 0;  // samples of a trace that have terms
  };

  void find_terms();
  /// task(terms of the trace, aimed, i, j) for every trace that has terms.
  template <class Task>
  void for_each_trace(const Task& task) const;

  std::span<const NodeState> state_;
  const SteeredPaths& paths_;
  GridShape shape_;
  std::array<float, terms> weight_;  // of each kind of term
  std::vector<std::uint8_t> terms_;  // one bit a kind: whether it counts at the node
  std::vector<Range> range_;         // one a trace
};

}  // namespace geosis
