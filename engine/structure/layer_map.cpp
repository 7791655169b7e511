#include "engine/structure/layer_map.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "engine/base/parallel.h"

namespace geosis {
namespace {

constexpr std::int64_t kSteps = 64;  // of the lattice between two nodes
constexpr std::size_t kPositionsATask = 4096;

/// A coordinate as the node below it and the lattice steps beyond.
struct Place {
  std::int32_t node;
  std::int64_t steps;
};

Place place_of(float coordinate) {
  const auto all = static_cast<std::int64_t>(coordinate * static_cast<float>(kSteps));
  return {static_cast<std::int32_t>(all / kSteps), all % kSteps};
}

}  // namespace

std::int32_t LayerMap::sample_at(std::int32_t i, std::int32_t j, std::int32_t layer) const {
  return std::clamp(paths_.sample_at(i, j, layer), region_.first.k, region_.last.k);
}

Vec3f LayerMap::to_samples(Vec3f position) const {
  const std::array<Place, 3> place = {place_of(position.x), place_of(position.y), place_of(position.z)};
  std::int64_t sum = 0;  // in 1/64^3
  for (int corner = 0; corner < 8; ++corner) {
    const std::array<std::int32_t, 3> end = {corner >> 2, corner >> 1 & 1, corner & 1};
    std::int64_t weight = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      weight *= end[axis] != 0 ? place[axis].steps : kSteps - place[axis].steps;
    }
    if (weight == 0) continue;  // such a corner may lie outside the grid
    sum += weight * sample_at(place[0].node + end[0], place[1].node + end[1], place[2].node + end[2]);
  }
  const std::int64_t steps = (sum + kSteps * kSteps / 2) / (kSteps * kSteps);
  return {position.x, position.y, static_cast<float>(steps) / static_cast<float>(kSteps)};
}

std::vector<Vec3f> to_samples(const LayerMap& map, std::span<const Vec3f> positions, int threads) {
  std::vector<Vec3f> mapped(positions.size());
  const std::size_t tasks = (positions.size() + kPositionsATask - 1) / kPositionsATask;
  parallel_for(tasks, threads, [&](std::size_t task) {
    const std::size_t end = std::min((task + 1) * kPositionsATask, positions.size());
    for (std::size_t n = task * kPositionsATask; n < end; ++n) mapped[n] = map.to_samples(positions[n]);
  });
  return mapped;
}

}  // namespace geosis
