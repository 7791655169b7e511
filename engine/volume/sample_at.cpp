#include "engine/volume/sample_at.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/base/parallel.h"

namespace geosis {
namespace {

/// First node of the cell that a coordinate lies in; the last cell of the axis holds the axis's last node too.
std::int32_t cell_of(float coordinate, std::int32_t nodes) {
  return std::clamp(static_cast<std::int32_t>(coordinate), 0, std::max(nodes - 2, 0));
}

std::size_t brick_of(const BrickLayout& layout, Vec3f position) {
  GridIndex place;
  for (int axis = 0; axis < 3; ++axis) place[axis] = cell_of(position[axis], layout.shape()[axis]) / kBrickCells;
  return layout.number(place);
}

}  // namespace

BrickGroups group_by_brick(const BrickLayout& layout, std::span<const Vec3f> positions) {
  std::vector<std::uint32_t> brick(positions.size());
  std::vector<std::size_t> end(layout.brick_count() + 1, 0);
  for (std::size_t n = 0; n < positions.size(); ++n) {
    brick[n] = static_cast<std::uint32_t>(brick_of(layout, positions[n]));
    ++end[brick[n] + 1];
  }
  BrickGroups groups;
  for (std::size_t b = 0; b + 1 < end.size(); ++b) {
    if (end[b + 1] > 0) {
      groups.bricks.push_back(b);
      groups.first.push_back(end[b]);
    }
    end[b + 1] += end[b];
  }
  groups.first.push_back(positions.size());
  groups.order.resize(positions.size());
  for (std::size_t n = 0; n < positions.size(); ++n) groups.order[end[brick[n]]++] = static_cast<std::uint32_t>(n);
  return groups;
}

float interpolate(const BrickView& brick, Vec3f position) {
  std::int32_t cell[3];
  double upper[3];  // weight of the cell's upper side
  for (int axis = 0; axis < 3; ++axis) {
    const float local = position[axis] - static_cast<float>(brick.first[axis]);
    cell[axis] = cell_of(local, brick.extent[axis]);
    upper[axis] = static_cast<double>(local) - cell[axis];
  }
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1;
    std::size_t at = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const int side = (corner >> (2 - axis)) & 1;
      weight *= side ? upper[axis] : 1 - upper[axis];
      at = at * static_cast<std::size_t>(brick.extent[axis]) + static_cast<std::size_t>(cell[axis] + side);
    }
    if (weight != 0) sum += weight * static_cast<double>(brick.samples[at]);
  }
  return static_cast<float>(sum);
}

Result<std::vector<float>> sample_at(const BrickedVolume& volume, std::span<const Vec3f> positions, int threads,
                                     const Progress& progress) {
  const BrickGroups groups = group_by_brick(BrickLayout(volume.shape()), positions);
  std::vector<float> values(positions.size());
  std::vector<std::optional<Error>> errors(groups.bricks.size());
  parallel_for(groups.bricks.size(), threads, [&](std::size_t g) {
    if (progress.cancelled()) {
      errors[g] = Error{ErrorCode::cancelled, "sampling a volume was cancelled"};
      return;
    }
    const auto brick = volume.brick(groups.bricks[g]);
    if (!brick) {
      errors[g] = brick.error();
      return;
    }
    for (const std::uint32_t n : groups.of(g)) values[n] = interpolate(*brick, positions[n]);
  });
  for (auto& error : errors) {
    if (error) return *std::move(error);
  }
  return values;
}

}  // namespace geosis
