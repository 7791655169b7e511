#pragma once

#include <span>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/volume/grid.h"

namespace geosis {

/// One half of a symmetric smoothing kernel, [0] in the middle, that stands for a Gaussian: four equal box filters,
/// whose ends have a fractional weight, one after the other. Its variance is sigma squared exactly, its sum 1, its
/// reach at most 2 sqrt(3) sigma + 4; no exponential is evaluated, so that it is the same everywhere.
///
/// sigma    in nodes, not below zero; 0 = the kernel that changes nothing.
std::vector<float> smoothing_kernel(double sigma);

/// Smooths a field in place along the three axes, as if it were zero outside.
///
/// field    shape.count() finite numbers, sample fastest.
/// sigma    in nodes, one an axis.
/// cost     O(count * (sum of sigma)); memory: one plane of the field a thread. The same for any number of threads.
void smooth(std::span<float> field, GridShape shape, Vec3d sigma, int threads);

}  // namespace geosis
