#pragma once

#include <cstdint>

#include "engine/volume/bricks.h"

namespace geosis {

/// The part of a trace that lies in one brick: up to 64 samples from the brick's first layer on.
struct BrickRow {
  std::int32_t i = 0, j = 0, brick_k = 0;

  std::int32_t first_k() const { return brick_k * kBrickCells; }
};

}  // namespace geosis
