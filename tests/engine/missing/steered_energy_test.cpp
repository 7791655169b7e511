#include "engine/missing/plate/steered_energy.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/engine/missing/dense_plate.h"
#include "tests/support/random.h"

namespace geosis {
namespace {

constexpr GridShape kShape = {7, 6, 11};
constexpr Vec3d kSteps = {0.3, 0.2, 0.35};

Dips dips_of(GridShape shape, float per_inline, float per_crossline) {
  const auto count = static_cast<std::size_t>(shape.count());
  return {shape, std::vector<float>(count, per_inline), std::vector<float>(count, per_crossline)};
}

/// Random samples; a tenth of the nodes absent, a half wanted.
GapBox random_gap(GridShape shape, test::Random& random) {
  GapBox gap{{{}, shape, {}}, {}};
  for (std::int64_t n = 0; n < shape.count(); ++n) {
    gap.samples.value.push_back(random.between(-1, 1));
    const double draw = random.unit();
    gap.state.push_back(draw < 0.1 ? NodeState::absent : draw < 0.5 ? NodeState::known : NodeState::wanted);
  }
  return gap;
}

std::vector<float> with_slack(std::vector<float> values) {
  values.resize(values.size() + SteeredEnergy::kSlack, 0.0f);
  return values;
}

std::vector<float> gradient_of(const SteeredEnergy& energy, const std::vector<float>& x) {
  std::vector<float> result(x.size());
  energy.gradient(x, result);
  return result;
}

void expect_is_the_plate_on_the_grid(const GapBox& gap) {
  const SteeredPaths paths = follow_dips(dips_of(gap.samples.shape, 0, 0));
  const auto found = gradient_of(SteeredEnergy(gap.state, paths, kSteps), with_slack(gap.samples.value));
  std::vector<double> wanted;
  for (std::size_t n = 0; n < gap.state.size(); ++n) {
    if (gap.state[n] == NodeState::wanted) wanted.push_back(gap.samples.value[n]);
  }
  const auto expected = test::DensePlate(gap, kSteps).gradient(wanted);
  std::size_t next = 0;
  for (std::size_t n = 0; n < gap.state.size(); ++n) {
    ASSERT_NEAR(found[n], gap.state[n] == NodeState::wanted ? expected[next++] : 0.0, 1e-4) << n;
  }
}

TEST(SteeredEnergy, WithoutDipsIsThatOfThePlateOnTheGrid) {
  const std::uint64_t seed = test::test_seed(21);
  SCOPED_TRACE("seed " + std::to_string(seed));
  test::Random random(seed);
  for (const GridShape shape : {kShape, GridShape{1, 6, 9}, {5, 5, 3}, {3, 3, 1}, {2, 1, 2}}) {
    expect_is_the_plate_on_the_grid(random_gap(shape, random));
  }
}

TEST(SteeredEnergy, ForgetsTheTraceBefore) {
  const std::uint64_t seed = test::test_seed(23);
  SCOPED_TRACE("seed " + std::to_string(seed));
  test::Random random(seed);
  for (int n = 0; n < 20; ++n) {
    // Gaps that begin and end elsewhere on every trace.
    GapBox gap = random_gap({6, 6, 16}, random);
    for (int trace = 0; trace < 36; ++trace) {
      const int first = random.integer(0, 15), last = random.integer(0, 15);
      for (int k = 0; k < 16; ++k) {
        gap.state[static_cast<std::size_t>(trace * 16 + k)] =
            k >= first && k <= last ? NodeState::wanted : NodeState::known;
      }
    }
    expect_is_the_plate_on_the_grid(gap);
  }
}

TEST(SteeredEnergy, LinearFieldsOfAShearedGridCostNothing) {
  const GridShape shape = {9, 9, 40};
  const double dip_i = 0.75, dip_j = -1.25;
  GapBox gap{{{}, shape, {}}, {}};
  for (int i = 0; i < shape.inlines; ++i) {
    for (int j = 0; j < shape.crosslines; ++j) {
      for (int k = 0; k < shape.samples; ++k) {
        const double value = 0.1 * (k - 20 - dip_i * i - dip_j * j) + 0.2 * i - 0.3 * j;
        gap.samples.value.push_back(static_cast<float>(value));
        const bool is_inner = i > 2 && i < 6 && j > 2 && j < 6 && k > 12 && k < 28;
        gap.state.push_back(is_inner ? NodeState::wanted : NodeState::known);
      }
    }
  }
  const SteeredPaths paths = follow_dips(dips_of(shape, 0.75f, -1.25f));
  const SteeredEnergy energy(gap.state, paths, kSteps);
  for (const float g : gradient_of(energy, with_slack(gap.samples.value))) ASSERT_NEAR(g, 0, 2e-5);
}

TEST(SteeredEnergy, IsSymmetricAndNotNegativeUnderAnyDips) {
  const std::uint64_t seed = test::test_seed(22);
  SCOPED_TRACE("seed " + std::to_string(seed));
  test::Random random(seed);
  const GapBox gap = random_gap(kShape, random);
  Dips dips = dips_of(kShape, 0, 0);
  for (auto* field : {&dips.to_next_inline, &dips.to_next_crossline}) {
    for (float& dip : *field) dip = random.between(-4, 4);
  }
  const SteeredPaths paths = follow_dips(dips);
  const SteeredEnergy energy(gap.state, paths, kSteps);
  std::vector<float> x = with_slack(gap.samples.value), y = x;
  for (std::size_t n = 0; n < gap.state.size(); ++n) {
    const bool is_wanted = gap.state[n] == NodeState::wanted;
    x[n] = is_wanted ? random.between(-1, 1) : 0;
    y[n] = is_wanted ? random.between(-1, 1) : 0;
  }
  const auto dot_product = [](const std::vector<float>& a, const std::vector<float>& b) {
    double sum = 0;
    for (std::size_t n = 0; n < a.size(); ++n) sum += double{a[n]} * b[n];
    return sum;
  };
  const auto gradient_x = gradient_of(energy, x), gradient_y = gradient_of(energy, y);
  EXPECT_NEAR(dot_product(x, gradient_y), dot_product(y, gradient_x), 1e-3);
  EXPECT_GT(dot_product(x, gradient_x), 0);
}

TEST(FollowDips, GoesHalfADipUpAndDownFromTheMiddle) {
  // Dips that grow with depth: whoever goes there and back is where it started.
  const GridShape shape = {3, 3, 60};
  Dips dips = dips_of(shape, 0, 0);
  for (std::size_t n = 0; n < dips.to_next_inline.size(); ++n) {
    dips.to_next_inline[n] = 0.02f * static_cast<float>(n % 60);
    dips.to_next_crossline[n] = -1;
  }
  const SteeredPaths paths = follow_dips(dips);
  const auto at = [](int i, int j, int k) { return (static_cast<std::size_t>(i) * 3 + j) * 60 + k; };
  for (int k = 10; k < 50; ++k) {
    const float there = paths.depth[next_inline][at(0, 1, k)];
    const float back = sample_at(&paths.depth[previous_inline][at(1, 1, 0)], 60, there);
    EXPECT_NEAR(back, k, 0.001) << k;
    EXPECT_EQ(paths.depth[next_crossline][at(0, 1, k)], static_cast<float>(k - 1));
    EXPECT_NEAR(paths.depth[corner][at(0, 1, k)], there - 1, 0.02);
  }
}

/// A wave along depth on planes of that dip, all of it known.
GapBox wave_under(GridShape shape, double per_inline) {
  GapBox gap{{{}, shape, {}}, {}};
  for (int i = 0; i < shape.inlines; ++i) {
    for (int j = 0; j < shape.crosslines; ++j) {
      for (int k = 0; k < shape.samples; ++k) {
        gap.samples.value.push_back(static_cast<float>(std::sin((k - per_inline * i) / 2)));
        gap.state.push_back(NodeState::known);
      }
    }
  }
  return gap;
}

TEST(StepsAlongDips, ShrinkByWhatTheDipsExplain) {
  const GridShape shape = {6, 5, 60};
  const Vec3d steps = {0.3, 0.2, 0.35};
  const GapBox flat = wave_under(shape, 0), dipping = wave_under(shape, 0.5);
  EXPECT_EQ(steps_along_dips(flat.samples.value, flat.state, follow_dips(dips_of(shape, 0, 0)), steps), steps);
  const Vec3d found =
      steps_along_dips(dipping.samples.value, dipping.state, follow_dips(dips_of(shape, 0.5f, 0)), steps);
  EXPECT_GE(found.x, 0.35 / 20);
  EXPECT_LT(found.x, 0.1);
  EXPECT_EQ(found.y, steps.y);
  EXPECT_EQ(found.z, steps.z);
}

TEST(StepsAlongDips, DoNotGrowUnderWrongDips) {
  const GridShape shape = {6, 5, 60};
  const Vec3d steps = {0.3, 0.2, 0.35};
  const GapBox dipping = wave_under(shape, 0.5);
  EXPECT_EQ(steps_along_dips(dipping.samples.value, dipping.state, follow_dips(dips_of(shape, -2, 1)), steps), steps);
}

}  // namespace
}  // namespace geosis
