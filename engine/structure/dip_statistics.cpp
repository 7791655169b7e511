#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/structure/scan_dips.h"

namespace geosis {
namespace {

/// How many known dips of an axis have each size, in DipField's units.
std::vector<std::int64_t> count_sizes(const DipField& field, LinkAxis axis) {
  std::vector<std::int64_t> count(static_cast<std::size_t>(DipField::kSteepest * DipField::kDipScale) + 1);
  const GridShape shape = field.shape();
  for (std::int32_t i = 0; i < shape.inlines; ++i) {
    for (std::int32_t j = 0; j < shape.crosslines; ++j) {
      if (!field.has_link(i, j, axis)) continue;
      const std::int16_t* dip = field.dips(field.trace_of(i, j), axis);
      for (std::int32_t m = 0; m < field.dips(); ++m) {
        if (dip[m] != DipField::kUnknown) ++count[static_cast<std::size_t>(std::abs(dip[m]))];
      }
    }
  }
  return count;
}

double quantile(const std::vector<std::int64_t>& count, double share) {
  std::int64_t all = 0, below = 0;
  for (const std::int64_t n : count) all += n;
  for (std::size_t size = 0; size < count.size(); ++size) {
    below += count[size];
    if (static_cast<double>(below) >= share * static_cast<double>(all)) {
      return static_cast<double>(size) / DipField::kDipScale;
    }
  }
  return 0;
}

/// A line of dips of which some are known, `stride` traces apart.
struct Line {
  std::size_t first, stride, count;
};

/// Adds to sum and weight what the nearest known dips before and behind each unknown one say, by 1 / distance.
class Spreader {
 public:
  Spreader(const DipField& field, LinkAxis axis, std::vector<float>& sum, std::vector<float>& weight)
      : field_(field), axis_(axis), sum_(sum), weight_(weight) {}

  void add(const Line& line) {
    const auto dips = static_cast<std::size_t>(field_.dips());
    for (const bool is_forward : {true, false}) {
      nearest_.assign(dips, DipField::kUnknown);
      distance_.assign(dips, 0);
      for (std::size_t n = 0; n < line.count; ++n) {
        const std::size_t trace = line.first + (is_forward ? n : line.count - 1 - n) * line.stride;
        const std::int16_t* dip = field_.dips(trace, axis_);
        for (std::size_t m = 0; m < dips; ++m) {
          if (dip[m] != DipField::kUnknown) {
            nearest_[m] = dip[m];
            distance_[m] = 0;
          } else if (nearest_[m] != DipField::kUnknown) {
            const float share = 1.0f / static_cast<float>(++distance_[m]);
            sum_[trace * dips + m] += share * static_cast<float>(nearest_[m]);
            weight_[trace * dips + m] += share;
          }
        }
      }
    }
  }

 private:
  const DipField& field_;
  const LinkAxis axis_;
  std::vector<float>& sum_;
  std::vector<float>& weight_;
  std::vector<std::int16_t> nearest_;
  std::vector<std::int32_t> distance_;
};

}  // namespace

std::array<DipQuantiles, 2> dip_quantiles(const DipField& field) {
  std::array<DipQuantiles, 2> result;
  for (const LinkAxis axis : kLinkAxes) {
    const auto count = count_sizes(field, axis);
    result[static_cast<std::size_t>(axis)] = {quantile(count, 0.5), quantile(count, 0.95), quantile(count, 0.99)};
  }
  return result;
}

double share_steeper_than(const DipField& field, double dip) {
  double most = 0;
  for (const LinkAxis axis : kLinkAxes) {
    const auto count = count_sizes(field, axis);
    std::int64_t all = 0, steep = 0;
    for (std::size_t size = 0; size < count.size(); ++size) {
      all += count[size];
      if (static_cast<double>(size) > dip * DipField::kDipScale) steep += count[size];
    }
    if (all > 0) most = std::max(most, static_cast<double>(steep) / static_cast<double>(all));
  }
  return most;
}

void spread_dips(DipField& field, int threads) {
  const GridShape shape = field.shape();
  const auto dips = static_cast<std::size_t>(field.dips());
  const auto inlines = static_cast<std::size_t>(shape.inlines), crosslines = static_cast<std::size_t>(shape.crosslines);
  for (const LinkAxis axis : kLinkAxes) {
    const std::int16_t* all = field.dips(0, axis);
    const std::size_t count = field.trace_count() * dips;
    if (std::find(all, all + count, DipField::kUnknown) == all + count) continue;
    std::vector<float> sum(count), weight(count);
    parallel_for(inlines, threads, [&](std::size_t i) {
      Spreader(field, axis, sum, weight).add({i * crosslines, 1, crosslines});
    });
    parallel_for(crosslines, threads, [&](std::size_t j) {
      Spreader(field, axis, sum, weight).add({j, crosslines, inlines});
    });
    std::int16_t* dip = field.dips(0, axis);
    for (std::size_t n = 0; n < count; ++n) {
      if (dip[n] != DipField::kUnknown) continue;
      dip[n] = weight[n] > 0 ? static_cast<std::int16_t>(std::lround(sum[n] / weight[n])) : std::int16_t{0};
    }
  }
}

}  // namespace geosis
