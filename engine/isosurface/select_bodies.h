#pragma once

#include <cstdint>
#include <optional>

#include "engine/isosurface/labelled_surface.h"

namespace geosis {

/// Which bodies to keep; a body must pass every filter, and `largest` counts those that pass the others.
struct BodyFilter {
  bool seeded = false;                     ///< only bodies that hold one of the seeds
  double min_voxels = 0;                   ///< only bodies with at least that volume_voxels
  std::optional<std::uint32_t> largest{};  ///< only so many
};

/// Removes the other bodies' vertices and triangles. What stays keeps its order; bodies are numbered 0, 1, 2, ... anew
/// in the same order, and a seed of a removed body has none. A body that lies in another's cavity is one of its own.
///
/// cost     O(vertices + triangles); nothing when all stay.
void select_bodies(LabelledSurface& surface, const BodyFilter& filter);

}  // namespace geosis
