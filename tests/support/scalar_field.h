#pragma once

#include <cstddef>
#include <vector>

#include "engine/volume/grid.h"

namespace geosis::test {

/// Samples of a small volume in one array, sample fastest; NaN = missing.
struct ScalarField {
  explicit ScalarField(GridShape grid, float value = 0)
      : shape(grid), samples(static_cast<std::size_t>(grid.count()), value) {}

  std::size_t index(GridIndex n) const {
    return (static_cast<std::size_t>(n.i) * shape.crosslines + n.j) * shape.samples + n.k;
  }
  float at(GridIndex n) const { return samples[index(n)]; }
  float& at(GridIndex n) { return samples[index(n)]; }

  GridShape shape;
  std::vector<float> samples;
};

/// Calls visit(GridIndex) for every place of the box 0 <= n < shape, sample fastest.
template <class Visit>
void for_each_node(GridShape shape, Visit&& visit) {
  for (std::int32_t i = 0; i < shape.inlines; ++i)
    for (std::int32_t j = 0; j < shape.crosslines; ++j)
      for (std::int32_t k = 0; k < shape.samples; ++k) visit(GridIndex{i, j, k});
}

/// The nodes of the box as a field of their own.
ScalarField crop(const ScalarField& field, GridBox box);

/// The field with its outermost layer of samples set to value.
ScalarField with_outer_layer(ScalarField field, float value);

}  // namespace geosis::test
