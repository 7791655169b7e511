#pragma once

#include <vector>

#include "engine/base/vec3.h"
#include "engine/missing/gaps/gap_box.h"

namespace geosis::test {

/// The values of least bending energy at the wanted nodes of a tiny box, in the order of its nodes, by a dense matrix:
/// a list of all stencils, their squares summed, Cholesky's factorisation. Shares nothing with the solvers.
///
/// weights  c_a; scattered gaps, and those of one node, take 1 instead. The solution must be unique.
std::vector<double> least_bending(const GapBox& gap, Vec3d weights);

}  // namespace geosis::test
