#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tests/support/scalar_field.h"

/// Filling by the letter of its description, node by node over dense arrays: slow, and sharing no code with the engine.
namespace geosis::test {

/// Step lengths from all neighbouring pairs of the field.
std::array<double, 3> measure_steps(const ScalarField& field);

struct OracleNode {
  double value = 0;
  double distance = -1;  ///< effective, in step lengths; -1 = not filled
};

/// The axis barycentre of every missing node inside the outline, within max_distance steps of a valid sample.
std::vector<OracleNode> fill_slowly(const ScalarField& field, std::array<double, 3> steps,
                                    std::optional<double> max_distance);

/// The field with its filled values.
ScalarField filled_slowly(ScalarField field, const std::vector<OracleNode>& nodes);

}  // namespace geosis::test
