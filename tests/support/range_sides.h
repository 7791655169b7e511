#pragma once

#include <cmath>

#include "engine/isosurface/extract.h"
#include "tests/support/cell_topology.h"

/// Three views of a sample that the oracle's counts accept: side(f), and corner(f) with the same side. The ends of the
/// range are moved outwards by `apart`, which leaves the sides as they are and, small enough, decides ties alone.
namespace geosis::test {

/// The body of a range.
template <class T>
class BodySides {
 public:
  using Number = T;

  BodySides(IsoRange range, BodyMode mode, T apart) : low_(range.low), high_(range.high), mode_(mode), apart_(apart) {}

  Side side(float f) const {
    if (f < low_) return Side::below;
    if (f > high_) return mode_ == BodyMode::exact ? Side::above : Side::below;  // sampled: g < 0 on both
    return Side::inside;
  }

  CornerValue<T> corner(float f) const {
    if (mode_ == BodyMode::sampled) return {side(f), {T(-T(g(f)) - apart_), T(0)}};
    return {side(f), {beyond(low_, f, 1), beyond(high_, f, -1)}};
  }

 private:
  // Nothing lies beyond an open end; any number does, and an infinite one would only be slow.
  T beyond(float end, float f, int sign) const { return std::isinf(end) ? T(0) : T(sign * (T(end) - T(f)) - apart_); }
  double g(float f) const {
    const double rise = static_cast<double>(f) - low_, fall = static_cast<double>(high_) - f;
    return std::isinf(high_) ? rise : std::isinf(low_) ? fall : rise * fall;
  }

  float low_, high_;
  BodyMode mode_;
  T apart_;
};

/// One end of the range: no sample lies between, what does is the surface {f = level} alone.
template <class T>
class LevelSides {
 public:
  using Number = T;

  LevelSides(float level, bool level_is_above, T apart)
      : level_(level), level_is_above_(level_is_above), apart_(level_is_above ? apart : T(-apart)) {}

  Side side(float f) const { return f > level_ || (f == level_ && level_is_above_) ? Side::above : Side::below; }

  CornerValue<T> corner(float f) const {
    const T rise = T(f) - T(level_) + apart_;
    return {side(f), {T(-rise), rise}};
  }

 private:
  float level_;
  bool level_is_above_;
  T apart_;
};

/// The one level, zero, of the sampled mode's g: inside is above it.
template <class T>
class ProductSides {
 public:
  using Number = T;

  ProductSides(IsoRange range, T apart) : body_(range, BodyMode::sampled, apart) {}

  Side side(float f) const { return body_.side(f) == Side::inside ? Side::above : Side::below; }

  CornerValue<T> corner(float f) const {
    const T below = body_.corner(f).excess[kBelow];
    return {side(f), {below, T(-below)}};
  }

 private:
  BodySides<T> body_;
};

}  // namespace geosis::test
