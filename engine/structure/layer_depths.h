#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/volume/grid.h"

namespace geosis {

/// Real depths of a sheaf of layers on every trace, on the way to whole samples. Layer l lies at depth first + l *
/// spacing on the reference trace when it is painted; layers between these are linear.
///
/// depth (inlines, crosslines, layers), layer fastest, in samples; it rises with the layer, and may lie outside the
/// box.
struct LayerDepths {
  GridShape shape;  ///< of the volume
  std::int32_t layers = 0;
  std::int32_t spacing = 1;
  std::int32_t first = 0;
  std::size_t reference = 0;  ///< trace
  std::vector<float> depth = {};

  std::size_t trace_count() const {
    return static_cast<std::size_t>(shape.inlines) * static_cast<std::size_t>(shape.crosslines);
  }
  float* trace(std::size_t t) { return depth.data() + t * static_cast<std::size_t>(layers); }
  const float* trace(std::size_t t) const { return depth.data() + t * static_cast<std::size_t>(layers); }
};

/// Layers that follow one another rise by at least this part of their spacing.
inline constexpr float kLeastRise = 0.1f;

/// Makes one trace's depths rise so, from the top.
inline void make_rising(float* depth, std::int32_t layers, std::int32_t spacing) {
  const float least = kLeastRise * static_cast<float>(spacing);
  for (std::int32_t l = 1; l < layers; ++l) {
    if (depth[l] < depth[l - 1] + least) depth[l] = depth[l - 1] + least;
  }
}

}  // namespace geosis
