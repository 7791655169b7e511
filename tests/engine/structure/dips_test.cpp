#include "engine/structure/dips.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/random.h"

namespace geosis {
namespace {

constexpr GridShape kShape = {24, 26, 70};
constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

/// An amplitude that swings along depth with periods of 11 to 26 samples.
double reflector(double depth) {
  return std::sin(depth / 1.8 + 0.4) + 0.7 * std::sin(depth / 2.9) + 0.5 * std::cos(depth / 4.1 + 1);
}

/// Plane reflectors that fall by so many samples from inline to inline and from crossline to crossline.
SampleBox planes(double per_inline, double per_crossline, double noise = 0, std::uint64_t seed = 1) {
  SampleBox box{{}, kShape, {}};
  test::Random random(seed);
  for (int i = 0; i < kShape.inlines; ++i) {
    for (int j = 0; j < kShape.crosslines; ++j) {
      for (int k = 0; k < kShape.samples; ++k) {
        const double clean = reflector(k - per_inline * i - per_crossline * j);
        box.value.push_back(static_cast<float>(clean + noise * (2 * random.unit() - 1)));
      }
    }
  }
  return box;
}

Dips by_warping(const SampleBox& box, const DipOptions& options = {}) {
  NoProgress progress;
  auto found = find_dips_by_warping(box, options, progress);
  EXPECT_TRUE(found);
  return std::move(*found);
}

TensorDips by_tensor(const SampleBox& box, const DipOptions& options = {}) {
  NoProgress progress;
  auto found = find_dips_by_tensor(box, options, progress);
  EXPECT_TRUE(found);
  return std::move(*found);
}

/// Root mean square error of a dip, `border` samples away from top and bottom.
double dip_error(const std::vector<float>& dip, double truth, int border = 12) {
  double sum = 0;
  int count = 0;
  for (std::size_t n = 0; n < dip.size(); ++n) {
    const auto k = static_cast<int>(n % static_cast<std::size_t>(kShape.samples));
    if (k < border || k >= kShape.samples - border) continue;
    sum += (dip[n] - truth) * (dip[n] - truth);
    ++count;
  }
  return std::sqrt(sum / count);
}

double mean(const std::vector<float>& values) {
  double sum = 0;
  for (const float v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

struct PlaneCase {
  double per_inline, per_crossline;
};

TEST(WarpingDips, OfPlaneReflectorsAreFound) {
  for (const auto& [a, b] : {PlaneCase{0.3, -0.2}, {1, 0.5}, {-2, 1.5}, {3, 0}}) {
    const Dips dips = by_warping(planes(a, b));
    EXPECT_LT(dip_error(dips.to_next_inline, a), 0.03) << a << ' ' << b;
    EXPECT_LT(dip_error(dips.to_next_crossline, b), 0.03) << a << ' ' << b;
  }
}

TEST(TensorDips, OfPlaneReflectorsAreFound) {
  for (const auto& [a, b] : {PlaneCase{0.3, -0.2}, {1, 0.5}, {-1.5, 1}}) {
    const TensorDips found = by_tensor(planes(a, b));
    EXPECT_LT(dip_error(found.dips.to_next_inline, a), 0.1) << a << ' ' << b;
    EXPECT_LT(dip_error(found.dips.to_next_crossline, b), 0.1) << a << ' ' << b;
    EXPECT_GT(mean(found.planarity), 0.95) << a << ' ' << b;
  }
}

TEST(WarpingDips, OfFlatReflectorsAreZero) {
  const Dips dips = by_warping(planes(0, 0));
  EXPECT_LT(dip_error(dips.to_next_inline, 0, 0), 1e-6);
  EXPECT_LT(dip_error(dips.to_next_crossline, 0, 0), 1e-6);
}

TEST(WarpingDips, WithstandNoise) {
  const std::uint64_t seed = test::test_seed(3);
  SCOPED_TRACE("seed " + std::to_string(seed));
  const SampleBox box = planes(0.7, -0.4, 0.25, seed);  // 15 % of the deviation
  EXPECT_LT(dip_error(by_warping(box).to_next_inline, 0.7), 0.08);
  EXPECT_LT(dip_error(by_tensor(box).dips.to_next_crossline, -0.4), 0.08);
}

TEST(WarpingDips, FlowIntoDeadTraces) {
  const SampleBox truth = planes(0.8, 0.3);
  SampleBox box = truth;
  for (int i = 8; i < 13; ++i) {
    for (int j = 10; j < 15; ++j) {
      for (int k = 0; k < kShape.samples; ++k) box.value[box.at(i, j, k)] = kMissing;
    }
  }
  const Dips dips = by_warping(box);
  EXPECT_LT(dip_error(dips.to_next_inline, 0.8), 0.03);
  EXPECT_LT(dip_error(dips.to_next_crossline, 0.3), 0.03);
}

TEST(WarpingDips, BelieveMeasuredSamplesMoreThanFilledOnes) {
  SampleBox box = planes(0.8, 0.3);
  std::vector<std::uint8_t> measured(box.value.size(), 1);
  for (int i = 8; i < 13; ++i) {
    for (int j = 10; j < 15; ++j) {
      for (int k = 0; k < kShape.samples; ++k) {
        box.value[box.at(i, j, k)] = static_cast<float>(reflector(k));  // flat: wrong
        measured[box.at(i, j, k)] = 0;
      }
    }
  }
  const double doubting = dip_error(by_warping(box, {.measured = measured}).to_next_inline, 0.8);
  const double believing = dip_error(by_warping(box).to_next_inline, 0.8);
  EXPECT_LT(doubting, 0.03);
  EXPECT_GT(believing, 3 * doubting);
}

TEST(Dips, OfAConstantBoxAreZeroAndNotPlanar) {
  const SampleBox box{{}, {6, 7, 20}, std::vector<float>(6 * 7 * 20, 3.5f)};
  const Dips dips = by_warping(box);
  const TensorDips tensor = by_tensor(box);
  for (const auto* field : {&dips.to_next_inline, &dips.to_next_crossline, &tensor.dips.to_next_inline,
                            &tensor.dips.to_next_crossline, &tensor.planarity}) {
    EXPECT_EQ(std::ranges::count(*field, 0.0f), 6 * 7 * 20);
  }
}

TEST(TensorDips, NoiseIsNotPlanar) {
  const SampleBox noise = [] {
    SampleBox box = planes(0, 0);
    test::Random random(5);
    for (float& v : box.value) v = random.between(-1, 1);
    return box;
  }();
  EXPECT_LT(mean(by_tensor(noise).planarity), 0.4);
}

/// The box with its inlines in the opposite order.
SampleBox mirrored(const SampleBox& box) {
  SampleBox result = box;
  for (int i = 0; i < box.shape.inlines; ++i) {
    for (int j = 0; j < box.shape.crosslines; ++j) {
      for (int k = 0; k < box.shape.samples; ++k) {
        result.value[box.at(box.shape.inlines - 1 - i, j, k)] = box.value[box.at(i, j, k)];
      }
    }
  }
  return result;
}

TEST(WarpingDips, ChangeSignWithTheOrderOfTheInlines) {
  const SampleBox box = planes(0.7, -0.4, 0.25);
  const Dips dips = by_warping(box), back = by_warping(mirrored(box));
  for (int i = 0; i + 1 < kShape.inlines; ++i) {
    for (int k = 0; k < kShape.samples; ++k) {
      ASSERT_NEAR(dips.to_next_inline[box.at(i, 5, k)], -back.to_next_inline[box.at(kShape.inlines - 2 - i, 5, k)],
                  1e-4);
      ASSERT_NEAR(dips.to_next_crossline[box.at(i, 5, k)], back.to_next_crossline[box.at(kShape.inlines - 1 - i, 5, k)],
                  1e-4);
    }
  }
}

TEST(Dips, DoNotDependOnScaleOrThreads) {
  const SampleBox box = planes(0.7, -0.4, 0.25);
  SampleBox huge = box;
  for (float& v : huge.value) v *= 0x1p126f;
  const Dips one = by_warping(box), other = by_warping(huge, {.threads = 3});
  EXPECT_EQ(one.to_next_inline, other.to_next_inline);
  EXPECT_EQ(one.to_next_crossline, other.to_next_crossline);
  const TensorDips tensor = by_tensor(box), same = by_tensor(huge, {.threads = 3});
  EXPECT_EQ(tensor.dips.to_next_inline, same.dips.to_next_inline);
  EXPECT_EQ(tensor.planarity, same.planarity);
}

TEST(Dips, OfBoxesThatAreThinOrAllMissingAreFinite) {
  for (const GridShape shape : {GridShape{1, 1, 1}, {1, 9, 3}, {4, 1, 2}, {3, 3, 1}}) {
    SampleBox box{{}, shape, {}};
    for (std::int64_t n = 0; n < shape.count(); ++n) box.value.push_back(static_cast<float>(n % 3));
    for (const bool missing : {false, true}) {
      if (missing) std::ranges::fill(box.value, kMissing);
      const Dips dips = by_warping(box);
      const TensorDips tensor = by_tensor(box);
      for (const auto* field : {&dips.to_next_inline, &dips.to_next_crossline, &tensor.planarity}) {
        ASSERT_EQ(static_cast<std::int64_t>(field->size()), shape.count());
        EXPECT_TRUE(std::ranges::all_of(*field, [](float v) { return std::isfinite(v); }));
      }
    }
  }
}

class Cancelled final : public Progress {
 public:
  void report(const char*, double) override {}
  bool cancelled() const override { return true; }
};

TEST(Dips, CanBeCancelled) {
  const Cancelled progress;
  const SampleBox box = planes(0, 0);
  const auto warping = find_dips_by_warping(box, {}, progress);
  const auto tensor = find_dips_by_tensor(box, {}, progress);
  ASSERT_FALSE(warping);
  ASSERT_FALSE(tensor);
  EXPECT_EQ(warping.error().code, ErrorCode::cancelled);
  EXPECT_EQ(tensor.error().code, ErrorCode::cancelled);
}

}  // namespace
}  // namespace geosis
