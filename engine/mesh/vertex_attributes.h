#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/vec3.h"

namespace geosis {

/// What a mesh's vertices carry besides their position. Each array has one entry a vertex, or none at all.
struct VertexAttributes {
  std::vector<std::uint8_t> reliability = {};  ///< 255 = between measured samples only, 0 = nothing is known there
  std::vector<std::uint32_t> body = {};        ///< which body the vertex bounds; the same on every level
  std::vector<float> value = {};               ///< of another volume at the vertex; NaN = missing there
  std::vector<std::uint8_t> agreement = {};    ///< of traces around a structural grid's vertex, in 1/255
  std::vector<Vec3f> normal = {};              ///< unit, out of the body, in the coordinates of the positions

  bool empty() const {
    return reliability.empty() && body.empty() && value.empty() && agreement.empty() && normal.empty();
  }
};

}  // namespace geosis
