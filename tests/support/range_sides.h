#pragma once

#include <cmath>

#include "engine/isosurface/extract.h"
#include "tests/support/cell_topology.h"

/// Three views of a sample that the oracle's counts accept: side(f), and corner(f) with the same side.
namespace geosis::test {

/// The body of a range.
class BodySides {
 public:
  BodySides(IsoRange range, BodyMode mode) : low_(range.low), high_(range.high), mode_(mode) {}

  Side side(float f) const {
    if (f < low_) return Side::below;
    if (f > high_) return mode_ == BodyMode::exact ? Side::above : Side::below;  // sampled: g < 0 on both
    return Side::inside;
  }

  CornerValue corner(float f) const {
    if (mode_ == BodyMode::sampled) return {side(f), {-g(f), 0}};
    return {side(f), {beyond(low_, f, 1), beyond(high_, f, -1)}};
  }

 private:
  // Nothing lies beyond an open end; any number does, and an infinite one would only be slow.
  static long double beyond(float end, float f, int sign) {
    return std::isinf(end) ? 0 : sign * (static_cast<long double>(end) - f);
  }
  double g(float f) const {
    const double rise = static_cast<double>(f) - low_, fall = static_cast<double>(high_) - f;
    return std::isinf(high_) ? rise : std::isinf(low_) ? fall : rise * fall;
  }

  float low_, high_;
  BodyMode mode_;
};

/// One end of the range: no sample lies between, what does is the surface {f = level} alone.
class LevelSides {
 public:
  LevelSides(float level, bool level_is_above) : level_(level), level_is_above_(level_is_above) {}

  Side side(float f) const { return f > level_ || (f == level_ && level_is_above_) ? Side::above : Side::below; }

  CornerValue corner(float f) const {
    const long double rise = f - static_cast<long double>(level_);
    return {side(f), {-rise, rise}};
  }

 private:
  float level_;
  bool level_is_above_;
};

/// The one level, zero, of the sampled mode's g: inside is above it.
class ProductSides {
 public:
  explicit ProductSides(IsoRange range) : body_(range, BodyMode::sampled) {}

  Side side(float f) const { return body_.side(f) == Side::inside ? Side::above : Side::below; }

  CornerValue corner(float f) const {
    const long double below = body_.corner(f).excess[kBelow];
    return {side(f), {below, -below}};
  }

 private:
  BodySides body_;
};

}  // namespace geosis::test
