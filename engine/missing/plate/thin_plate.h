#pragma once

#include "engine/base/progress.h"
#include "engine/base/vec3.h"
#include "engine/missing/gaps/gap_box.h"
#include "engine/missing/plate/thin_plate_options.h"

namespace geosis {

/// Fills the wanted nodes of a box as a thin plate that is clamped at the known ones: the values of least bending
///
///     E = sum_a c_a^2 (f(x-e_a) - 2 f(x) + f(x+e_a))^2
///       + sum_{a<b} 2 c_a c_b (f(x) - f(x+e_a) - f(x+e_b) + f(x+e_a+e_b))^2,     c_a = 1 / h_a^2,
///
/// over all stencils of the box that hold a wanted node and no absent one. Linear fields bend nowhere and come back;
/// at absent nodes and at the box's faces the plate ends free. Gaps are wanted nodes joined by stencils; each is solved
/// by itself, so its values do not depend on what else the box holds, provided the box reaches two nodes further than
/// the gap wherever the volume does.
///
/// Single nodes and scattered gaps (PlateGap) take c_a = 1: between close samples on every axis, step lengths that are
/// measured over a whole volume do harm.
///
/// step_lengths  h, per axis, above zero; only their ratios count. Known nodes are finite.
/// result        every wanted node is finite and in [low, high]; the same for any number of calling threads. A node
///               that no stencil holds keeps its starting value. After cancellation some nodes hold unfinished values.
/// cost          scattered nodes and traces about 0.3 us each, wide gaps 1 us per node of the gap's bounding box;
///               memory: at most 60 bytes per node of the box besides the box itself. Serial.
/// source        Duchon 1977 (thin plates); Hestenes and Stiefel 1952; for wide gaps see wide_plate.h.
void fill_thin_plate(GapBox& gap, const Vec3d& step_lengths, const ThinPlateOptions& options, const Progress& progress);

}  // namespace geosis
