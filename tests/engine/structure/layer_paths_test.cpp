#include "engine/structure/layer_paths.h"

#include <vector>

#include <gtest/gtest.h>

#include "tests/support/random.h"

namespace geosis {
namespace {

/// A path of so many layers over all samples, its steps at random places.
std::vector<std::int32_t> random_path(std::int32_t samples, std::int32_t layers, test::Random& random) {
  std::vector<std::int32_t> path = {0};
  for (std::int32_t left = layers - 1; left > 0; --left) {
    const std::int32_t steps_left = samples - 1 - path.back();
    path.push_back(path.back() + (random.integer(1, left) <= steps_left ? 1 : 0));
  }
  return path;
}

TEST(LayerPaths, GiveBackEveryPath) {
  const std::uint64_t seed = test::test_seed(11);
  SCOPED_TRACE("seed " + std::to_string(seed));
  test::Random random(seed);
  for (int round = 0; round < 60; ++round) {
    const GridShape shape = {random.integer(1, 4), random.integer(1, 4), random.integer(1, 150)};
    const std::int32_t layers = shape.samples + random.integer(0, 200);
    LayerPaths paths(shape, layers);
    std::vector<std::vector<std::int32_t>> truth;
    for (std::int32_t i = 0; i < shape.inlines; ++i) {
      for (std::int32_t j = 0; j < shape.crosslines; ++j) {
        truth.push_back(random_path(shape.samples, layers, random));
        paths.set(i, j, truth.back());
      }
    }
    EXPECT_TRUE(paths.is_sound());
    std::size_t trace = 0;
    for (std::int32_t i = 0; i < shape.inlines; ++i) {
      for (std::int32_t j = 0; j < shape.crosslines; ++j, ++trace) {
        std::vector<std::int32_t> path(static_cast<std::size_t>(layers));
        paths.get(i, j, path);
        ASSERT_EQ(path, truth[trace]);
        for (std::int32_t u = 0; u < layers; ++u)
          ASSERT_EQ(paths.sample_at(i, j, u), path[static_cast<std::size_t>(u)]);
        for (std::int32_t k = 0; k < shape.samples; ++k) {
          const std::int32_t u = paths.layer_of(i, j, k);
          ASSERT_EQ(paths.sample_at(i, j, u), k);
          if (u > 0) {
            ASSERT_EQ(paths.sample_at(i, j, u - 1), k - 1);
          }
        }
      }
    }
  }
}

TEST(LayerPaths, FromDamagedWordsAreNotSound) {
  const GridShape shape = {2, 2, 70};
  LayerPaths paths(shape, 90);
  test::Random random(5);
  for (std::int32_t i = 0; i < 2; ++i) {
    for (std::int32_t j = 0; j < 2; ++j) paths.set(i, j, random_path(shape.samples, 90, random));
  }
  const std::vector<std::uint64_t> sound(paths.words().begin(), paths.words().end());
  EXPECT_TRUE(LayerPaths(shape, 90, sound).is_sound());
  for (std::size_t word = 0; word < sound.size(); ++word) {
    for (const int bit : {0, 20, 63}) {
      auto damaged = sound;
      damaged[word] ^= std::uint64_t{1} << bit;
      EXPECT_FALSE(LayerPaths(shape, 90, damaged).is_sound()) << word << ' ' << bit;
    }
  }
  auto moved = sound;  // as many steps, but one behind the last layer
  moved[1] &= moved[1] - 1;
  moved[1] |= std::uint64_t{1} << 60;
  EXPECT_FALSE(LayerPaths(shape, 90, moved).is_sound());
}

}  // namespace
}  // namespace geosis
