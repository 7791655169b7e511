#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/volume/grid.h"

namespace geosis {

/// A trace's link: to the next inline (0) or to the next crossline (1).
enum class LinkAxis : std::uint8_t { inline_ = 0, crossline = 1 };
inline constexpr std::array<LinkAxis, 2> kLinkAxes = {LinkAxis::inline_, LinkAxis::crossline};

/// Dips of a whole volume's links, and how well the linked traces agree along them: small enough to be held beside it.
///
/// Dips are as in `Dips` (dips.h), at every second sample, in 1/2048 sample a trace; agreement (the normalised
/// correlation of the two traces around the place, once they are warped; below zero counts as zero) at every fourth, in
/// 1/255. Between them they are linear, beyond the first and last constant. 2.5 bytes a sample.
class DipField {
 public:
  static constexpr std::int32_t kDipSpacing = 2, kAgreementSpacing = 4;
  static constexpr float kDipScale = 2048;
  static constexpr float kSteepest = 12;            ///< samples a trace
  static constexpr std::int16_t kUnknown = -32768;  ///< a dip that nothing tells; spread_dips() leaves none

  DipField() = default;
  explicit DipField(GridShape shape)
      : shape_(shape),
        dips_((shape.samples - 1) / kDipSpacing + 1),
        agreements_((shape.samples - 1) / kAgreementSpacing + 1) {
    for (auto& field : dip_) field.resize(trace_count() * static_cast<std::size_t>(dips_));
    for (auto& field : agreement_) field.resize(trace_count() * static_cast<std::size_t>(agreements_));
  }

  GridShape shape() const { return shape_; }
  std::size_t trace_count() const {
    return static_cast<std::size_t>(shape_.inlines) * static_cast<std::size_t>(shape_.crosslines);
  }
  std::size_t trace_of(std::int32_t i, std::int32_t j) const {
    return static_cast<std::size_t>(i) * static_cast<std::size_t>(shape_.crosslines) + static_cast<std::size_t>(j);
  }
  bool has_link(std::int32_t i, std::int32_t j, LinkAxis axis) const {
    return axis == LinkAxis::inline_ ? i + 1 < shape_.inlines : j + 1 < shape_.crosslines;
  }

  std::int32_t dips() const { return dips_; }  ///< stored a trace
  std::int32_t agreements() const { return agreements_; }
  std::int16_t* dips(std::size_t trace, LinkAxis axis) { return &dip_[at(axis)][trace * dips_]; }
  const std::int16_t* dips(std::size_t trace, LinkAxis axis) const { return &dip_[at(axis)][trace * dips_]; }
  std::uint8_t* agreements(std::size_t trace, LinkAxis axis) { return &agreement_[at(axis)][trace * agreements_]; }
  const std::uint8_t* agreements(std::size_t trace, LinkAxis axis) const {
    return &agreement_[at(axis)][trace * agreements_];
  }

  /// Dip of the trace's link at a depth in samples.
  float dip(std::size_t trace, LinkAxis axis, float depth) const {
    return between(dips(trace, axis), dips_, depth * (1.0f / kDipSpacing)) * (1.0f / kDipScale);
  }
  /// Agreement, in [0, 1].
  float agreement(std::size_t trace, LinkAxis axis, float depth) const {
    return between(agreements(trace, axis), agreements_, depth * (1.0f / kAgreementSpacing)) * (1.0f / 255);
  }

  static std::int16_t stored(float dip) {
    return static_cast<std::int16_t>(std::lround(std::clamp(dip, -kSteepest, kSteepest) * kDipScale));
  }

 private:
  static std::size_t at(LinkAxis axis) { return static_cast<std::size_t>(axis); }

  template <class Number>
  static float between(const Number* values, std::int32_t count, float place) {
    const float clamped = std::clamp(place, 0.0f, static_cast<float>(count - 1));
    const auto below = std::min(static_cast<std::int32_t>(clamped), std::max(count - 2, 0));
    const auto low = static_cast<float>(values[below]);
    const auto high = static_cast<float>(values[std::min(below + 1, count - 1)]);
    return low + (high - low) * (clamped - static_cast<float>(below));
  }

  GridShape shape_;
  std::int32_t dips_ = 0, agreements_ = 0;
  std::array<std::vector<std::int16_t>, 2> dip_;
  std::array<std::vector<std::uint8_t>, 2> agreement_;
};

}  // namespace geosis
