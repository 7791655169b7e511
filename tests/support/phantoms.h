#pragma once

#include "tests/support/random.h"
#include "tests/support/scalar_field.h"

/// Fields whose bodies are known shapes. Lengths in voxels; centres are the middle of the grid, a little off the nodes.
namespace geosis::test {

/// radius - distance from the centre: {f >= 0} is a ball.
ScalarField sphere(GridShape shape, double radius);

/// Distance inside a ring around the sample axis: {f >= 0} is a solid torus.
ScalarField torus(GridShape shape, double ring_radius, double tube_radius);

/// {f >= 0} is a ball with two tunnels through it, along the sample axis.
ScalarField two_tunnels(GridShape shape, double radius, double tunnel_radius);

/// radius - distance from the centre, mirrored at thickness: {f >= 0} is a hollow ball.
ScalarField shell(GridShape shape, double radius, double thickness);

/// {0 <= f <= 1} is a pair of sheets across the sample axis, `gap` apart.
ScalarField two_sheets(GridShape shape, double gap);

/// The gyroid with the given period; amplitude about 1.
ScalarField gyroid(GridShape shape, double period);

/// a*i + b*j + c*k + d: trilinear cells reproduce it exactly.
ScalarField plane(GridShape shape, double a, double b, double c, double d);

/// Independent samples, uniform in [low, high).
ScalarField uniform_noise(GridShape shape, Random& random, float low, float high);

/// Independent whole numbers low ... high: many equal samples, and samples on whole levels.
ScalarField integer_noise(GridShape shape, Random& random, std::int32_t low, std::int32_t high);

/// Each sample becomes NaN with the given probability.
ScalarField with_holes(ScalarField field, Random& random, double probability);

}  // namespace geosis::test
