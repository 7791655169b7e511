#include "tests/support/scalar_field.h"

namespace geosis::test {

ScalarField crop(const ScalarField& field, GridBox box) {
  ScalarField part({box.last.i - box.first.i + 1, box.last.j - box.first.j + 1, box.last.k - box.first.k + 1});
  for_each_node(part.shape, [&](GridIndex n) {
    part.at(n) = field.at({box.first.i + n.i, box.first.j + n.j, box.first.k + n.k});
  });
  return part;
}

ScalarField with_outer_layer(ScalarField field, float value) {
  for_each_node(field.shape, [&](GridIndex n) {
    for (int axis = 0; axis < 3; ++axis)
      if (n[axis] == 0 || n[axis] == field.shape[axis] - 1) field.at(n) = value;
  });
  return field;
}

}  // namespace geosis::test
