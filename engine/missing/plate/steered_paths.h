#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/missing/gaps/gap_box.h"
#include "engine/structure/dips.h"

namespace geosis {

/// A neighbouring trace of (i, j): where it is, counted in traces.
struct TraceStep {
  std::int32_t inlines, crosslines;
};

/// The lateral neighbours that the steered plate knows.
enum Neighbour : std::size_t { next_inline, previous_inline, next_crossline, previous_crossline, corner, neighbours };
inline constexpr std::array<TraceStep, neighbours> kTraceSteps = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}}};

/// Where the reflector through a node crosses the neighbouring traces.
///
/// depth[n]  (inlines, crosslines, samples): depth on neighbour n, in samples, cut to the trace: reflectors crowd at
///           its ends. The corner's is the mean over the two ways round. The node's own where the box has no such
///           trace.
struct SteeredPaths {
  GridShape shape;
  std::array<std::vector<float>, neighbours> depth;
};

SteeredPaths follow_dips(const Dips& dips);

/// Linear interpolation in a trace of `count` samples; beyond its ends, the end's sample.
float sample_at(const float* trace, std::int32_t count, float depth);

/// The step lengths for neighbours along the reflectors: the lateral ones, less by as much as the samples there differ
/// less than on the same level, over all links between known nodes; at least a twentieth of the longest.
///
/// value    of the box, finite.
Vec3d steps_along_dips(std::span<const float> value, std::span<const NodeState> state, const SteeredPaths& paths,
                       const Vec3d& step_lengths);

/// Values to start from: for each wanted node the barycentre of the known samples that walks along the reflectors meet
/// in the four lateral directions, linear between two that face each other. Nodes that meet none keep theirs.
///
/// value    of the box, finite; wanted ones are replaced.
/// cost     O(wanted nodes * width of the gap)
void start_along_dips(std::span<float> value, std::span<const NodeState> state, const SteeredPaths& paths,
                      const Vec3d& step_lengths);

}  // namespace geosis
