#include <algorithm>
#include <cmath>
#include <cstddef>

#include "engine/base/parallel.h"
#include "engine/structure/structural_grid.h"

namespace geosis {
namespace {

constexpr std::size_t kPositionsATask = 8192;

/// The entry below a place, and how far it is to the next.
struct Place {
  std::int32_t below;
  float rest;
};
Place place_of(float coordinate, std::int32_t count) {
  const auto below = std::clamp(static_cast<std::int32_t>(coordinate), 0, std::max(count - 2, 0));
  return {below, std::clamp(coordinate - static_cast<float>(below), 0.0f, 1.0f)};
}

class Agreements {
 public:
  explicit Agreements(const StructuralGrid& grid)
      : grid_(grid),
        shape_(grid.paths.shape()),
        stored_((shape_.samples - 1) / StructuralGrid::kAgreementSpacing + 1) {}

  std::uint8_t at(Vec3f p) const {
    const Place i = place_of(p.x, shape_.inlines), j = place_of(p.y, shape_.crosslines),
                m = place_of(p.z / StructuralGrid::kAgreementSpacing, stored_);
    float sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const int a = corner >> 2, b = corner >> 1 & 1, c = corner & 1;
      const float weight =
          (a != 0 ? i.rest : 1 - i.rest) * (b != 0 ? j.rest : 1 - j.rest) * (c != 0 ? m.rest : 1 - m.rest);
      if (weight > 0) sum += weight * static_cast<float>(entry(i.below + a, j.below + b, m.below + c));
    }
    return static_cast<std::uint8_t>(std::lround(sum));
  }

 private:
  std::uint8_t entry(std::int32_t i, std::int32_t j, std::int32_t m) const {
    const auto trace = static_cast<std::size_t>(i) * shape_.crosslines + static_cast<std::size_t>(j);
    return grid_.agreement[trace * stored_ + std::min(m, stored_ - 1)];
  }

  const StructuralGrid& grid_;
  const GridShape shape_;
  const std::int32_t stored_;
};

}  // namespace

std::vector<std::uint8_t> agreement_at(const StructuralGrid& grid, std::span<const Vec3f> positions, int threads) {
  const Agreements agreements(grid);
  std::vector<std::uint8_t> result(positions.size());
  parallel_for((positions.size() + kPositionsATask - 1) / kPositionsATask, threads, [&](std::size_t task) {
    const std::size_t end = std::min((task + 1) * kPositionsATask, positions.size());
    for (std::size_t n = task * kPositionsATask; n < end; ++n) result[n] = agreements.at(positions[n]);
  });
  return result;
}

}  // namespace geosis
