#include "tests/support/layer_errors.h"

#include <cmath>
#include <cstddef>

namespace geosis::test {
namespace {

constexpr std::int32_t kBorder = 8;

bool counts(double depth, std::int32_t samples) {
  return depth >= kBorder && depth <= samples - 1 - kBorder;
}

}  // namespace

LayerDepths axis_depths(GridShape shape) {
  LayerDepths depths{.shape = shape, .layers = shape.samples};
  for (std::size_t t = 0; t < depths.trace_count(); ++t) {
    for (std::int32_t k = 0; k < shape.samples; ++k) depths.depth.push_back(static_cast<float>(k));
  }
  return depths;
}

LayerErrors layer_errors(const LayeredTruth& truth, const LayerDepths& depths) {
  const GridShape shape = depths.shape;
  const auto at = [&](std::int32_t i, std::int32_t j, std::int32_t l) {
    return double{depths.trace(static_cast<std::size_t>(i) * shape.crosslines + j)[l]};
  };
  double squares = 0, count = 0, near = 0, pairs = 0;
  for (std::int32_t l = 0; l < depths.layers; ++l) {
    double sum[4] = {}, number[4] = {}, sum_of_squares[4] = {};
    for (std::int32_t i = 0; i < shape.inlines; ++i) {
      for (std::int32_t j = 0; j < shape.crosslines; ++j) {
        const double depth = at(i, j, l);
        if (!counts(depth, shape.samples)) continue;
        const double layer = truth.layer_at(i, j, depth);
        const int block = truth.block(i, j);
        sum[block] += layer;
        sum_of_squares[block] += layer * layer;
        ++number[block];
        const auto compare = [&](std::int32_t a, std::int32_t b) {
          if (a >= shape.inlines || b >= shape.crosslines || !counts(at(a, b, l), shape.samples)) return;
          ++pairs;
          if (std::abs(truth.layer_at(a, b, at(a, b, l)) - layer) <= 0.5) ++near;
        };
        compare(i + 1, j);
        compare(i, j + 1);
      }
    }
    for (int block = 0; block < 4; ++block) {
      if (number[block] < 2) continue;
      squares += sum_of_squares[block] - sum[block] * sum[block] / number[block];
      count += number[block];
    }
  }
  return {std::sqrt(squares / count), near / pairs};
}

double dip_error(const LayeredTruth& truth, const DipField& field) {
  const GridShape shape = field.shape();
  double squares = 0, count = 0;
  for (std::int32_t i = 0; i + 1 < shape.inlines; ++i) {
    for (std::int32_t j = 0; j + 1 < shape.crosslines; ++j) {
      if (truth.block(i, j) != truth.block(i + 1, j) || truth.block(i, j) != truth.block(i, j + 1)) continue;
      const std::size_t trace = field.trace_of(i, j);
      for (std::int32_t k = kBorder; k < shape.samples - kBorder; ++k) {
        const double a = field.dip(trace, LinkAxis::inline_, static_cast<float>(k)) - truth.dip_to_next_inline(i, j, k);
        const double b =
            field.dip(trace, LinkAxis::crossline, static_cast<float>(k)) - truth.dip_to_next_crossline(i, j, k);
        squares += a * a + b * b;
        count += 2;
      }
    }
  }
  return std::sqrt(squares / count);
}

}  // namespace geosis::test
