#pragma once

#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "engine/missing/fill.h"
#include "engine/volume/brick_file.h"
#include "tests/support/phantoms.h"
#include "tests/support/random.h"

/// Fields with gaps, and volumes as fields.
namespace geosis::test {

inline constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

/// Samples of the box become missing.
inline ScalarField without(ScalarField field, GridBox box) {
  for (std::int32_t i = box.first.i; i <= box.last.i; ++i)
    for (std::int32_t j = box.first.j; j <= box.last.j; ++j)
      for (std::int32_t k = box.first.k; k <= box.last.k; ++k) field.at({i, j, k}) = kMissing;
  return field;
}

inline ScalarField without_trace(ScalarField field, std::int32_t i, std::int32_t j) {
  return without(std::move(field), {{i, j, 0}, {i, j, field.shape.samples - 1}});
}

/// Points, traces, lines, boxes and a muted top, each with some probability.
inline ScalarField with_random_gaps(ScalarField field, Random& random) {
  const GridShape shape = field.shape;
  if (random.unit() < 0.7) field = with_holes(std::move(field), random, random.unit() * random.unit());
  const double dead = random.unit() * random.unit();
  for (std::int32_t i = 0; i < shape.inlines; ++i)
    for (std::int32_t j = 0; j < shape.crosslines; ++j)
      if (random.unit() < dead) field = without_trace(std::move(field), i, j);
  if (random.unit() < 0.4) {  // lines that were not shot, whatever their number
    const std::int32_t i = random.integer(0, shape.inlines - 1), j = random.integer(0, shape.crosslines - 1);
    field = without(std::move(field), {{i, 0, 0}, {i, shape.crosslines - 1, shape.samples - 1}});
    if (random.unit() < 0.5) field = without(std::move(field), {{0, j, 0}, {shape.inlines - 1, j, shape.samples - 1}});
  }
  for (int box = 0; box < random.integer(0, 3); ++box) {
    GridBox gap;
    for (int axis = 0; axis < 3; ++axis) {
      gap.first[axis] = random.integer(0, shape[axis] - 1);
      gap.last[axis] = random.integer(gap.first[axis], shape[axis] - 1);
    }
    field = without(std::move(field), gap);
  }
  if (random.unit() < 0.3)
    field = without(std::move(field),
                    {{0, 0, 0}, {shape.inlines - 1, shape.crosslines - 1, random.integer(0, shape.samples - 1)}});
  return field;
}

inline std::unique_ptr<BrickedVolume> volume_of(const ScalarField& field) {
  return make_bricked_volume(field.shape, field.samples);
}

/// All samples, from the bricks.
inline ScalarField samples_of(const BrickedVolume& volume) {
  ScalarField field(volume.shape());
  for (std::size_t brick = 0; brick < volume.brick_count(); ++brick) {
    const auto view = volume.brick(brick);
    EXPECT_TRUE(view);
    if (!view) return field;
    const float* sample = view->samples;
    for_each_node(view->extent, [&](GridIndex n) {
      field.at({view->first.i + n.i, view->first.j + n.j, view->first.k + n.k}) = *sample++;
    });
  }
  return field;
}

inline std::unique_ptr<FilledVolume> fill(const BrickedVolume& volume,
                                          FillOptions options = {.method = FillMethod::linear}) {
  NoProgress unwatched;
  auto filled = fill_missing(volume, options, std::nullopt, 1, unwatched);
  EXPECT_TRUE(filled) << filled.error().message;
  return filled ? *std::move(filled) : nullptr;
}

/// The field, filled.
inline ScalarField fill(const ScalarField& field, FillOptions options = {.method = FillMethod::linear}) {
  const auto volume = volume_of(field);
  return samples_of(*fill(*volume, options));
}

}  // namespace geosis::test
