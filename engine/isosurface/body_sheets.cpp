#include "engine/isosurface/body_sheets.h"

#include <algorithm>
#include <cmath>

#include "engine/mesh/indexed_mesh.h"

namespace geosis {
namespace {

/// g, formed once in double. An infinite end leaves the other factor alone.
double product_value(float f, float low, float high) {
  const double from_low = static_cast<double>(f) - low, to_high = static_cast<double>(high) - f;
  if (std::isinf(low)) return to_high;
  if (std::isinf(high)) return from_low;
  return from_low * to_high;
}

/// Scales by a power of two so that the largest magnitude is near 1: degree 4 then does not overflow a double. Nothing
/// is lost: g is a multiple of 2^-298 and smaller than 2^258.
void normalise(std::array<double, 8>& values) {
  double largest = 0;
  for (double v : values) largest = std::max(largest, std::fabs(v));
  if (largest == 0) return;
  const int exponent = std::ilogb(largest);
  for (double& v : values) v = std::scalbn(v, -exponent);
}

}  // namespace

CellValues Sheet::cell_values(const std::array<float, 8>& samples) const {
  CellValues cell;
  cell.ties_above = body_is_above();
  if (kind == Kind::product) {
    for (int c = 0; c < 8; ++c) cell.value[c] = product_value(samples[c], low, high);
    normalise(cell.value);
    return cell;
  }
  for (int c = 0; c < 8; ++c) cell.value[c] = samples[c];
  cell.level = kind == Kind::low_end ? low : high;
  return cell;
}

int Sheet::crossing_step(float f0, float f1) const {
  double level = kind == Kind::low_end ? low : high;
  if (kind == Kind::product) level = std::min(f0, f1) < low ? low : high;  // the end that the outer node is beyond
  const double t = (level - f0) / (static_cast<double>(f1) - f0);
  const double step = std::floor(t * kLatticeStepsPerVoxel + 0.5);
  return static_cast<int>(std::clamp(step, 1.0, kLatticeStepsPerVoxel - 1.0));
}

BodySheets sheets_of(IsoRange range, BodyMode mode) {
  BodySheets sheets;
  const bool has_low = !std::isinf(range.low), has_high = !std::isinf(range.high);
  const auto add = [&](Sheet::Kind kind) { sheets.sheet[sheets.count++] = {kind, range.low, range.high}; };
  if (mode == BodyMode::sampled) {
    if (has_low || has_high) add(Sheet::Kind::product);
    return sheets;
  }
  if (has_low) add(Sheet::Kind::low_end);
  if (has_high) add(Sheet::Kind::high_end);
  return sheets;
}

void separate_steps(int& first, int& second) {
  if (first < second) return;
  second = first + 1;
  if (second < kLatticeStepsPerVoxel) return;
  second = kLatticeStepsPerVoxel - 1;
  first = second - 1;
}

}  // namespace geosis
