#pragma once

#include <span>

#include "engine/base/progress.h"
#include "engine/base/vec3.h"
#include "engine/missing/gaps/gap_box.h"
#include "engine/missing/plate/plate_gaps.h"
#include "engine/missing/plate/thin_plate.h"

namespace geosis {

/// How a wide gap was solved.
struct WidePlateEffort {
  int rounds = 0, iterations = 0;
};

/// Solves one gap of any width: conjugate gradients, preconditioned by two Poisson V-cycles (away from the rim the
/// energy's operator is L L). Vectors are float32, the solution is double; every round starts from the solution's own
/// residual in double and gains up to four digits.
///
/// nodes    all nodes of the gap.
/// weights  c_a of the energy, the largest 1.
/// cost     8 iterations for a cube of 20^3 nodes, 21 for 100^3, about 35 ns per node of its bounding box and
///          iteration; memory: 41 bytes per node of the bounding box with two nodes round it, 4 per node of the gap.
/// source   Glowinski and Pironneau 1979 (the biharmonic problem by two Poisson problems).
WidePlateEffort fill_wide_plate(GapBox& gap, std::span<const PlateNode> nodes, Vec3d weights,
                                const ThinPlateOptions& options, const Progress& progress);

}  // namespace geosis
