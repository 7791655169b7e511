#include <functional>
#include <iostream>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/property/surface_laws.h"
#include "tests/support/phantoms.h"

// Laws of extract_body over families of random fields. GEOSIS_SEED=n runs them on other fields.

namespace geosis::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr GridShape kSmall{5, 5, 5};

struct Family {
  std::string name;
  std::function<ScalarField(Random&)> field;
  std::function<IsoRange(Random&)> range;
  int fields = 0;
  double most_undecided = 0.01;  ///< share of the fields whose topology may stay uncompared
};

ScalarField noise(Random& random) {
  return uniform_noise(kSmall, random, -1, 1);
}
ScalarField scaled(ScalarField field, float scale) {
  for (float& f : field.samples) f *= scale;
  return field;
}
IsoRange above(Random& random) {
  return {random.between(-0.4f, 0.4f), kInf};
}
IsoRange under(Random& random) {
  return {-kInf, random.between(-0.4f, 0.4f)};
}
IsoRange band(Random& random) {
  return {random.between(-0.6f, 0), random.between(0, 0.6f)};
}
IsoRange slab(Random& random) {
  const float level = random.between(-0.4f, 0.4f);
  return {level, level};
}
IsoRange whole_levels(Random& random) {
  const auto low = static_cast<float>(random.integer(-2, 1));
  return {low, low + static_cast<float>(random.integer(0, 2))};
}

std::vector<Family> families() {
  const auto closed = [](Random& r) { return with_outer_layer(noise(r), -2); };
  const auto holes = [](Random& r) { return with_holes(noise(r), r, 0.02 + 0.08 * r.unit()); };
  return {
      {"OpenAbove", noise, above, 1000},
      {"OpenUnder", noise, under, 500},
      {"OpenBand", noise, band, 1000},
      {"ClosedAbove", closed, above, 1000},
      {"ClosedBand", closed, band, 1000},
      {"Slab", noise, slab, 300},
      {"HolesAbove", holes, above, 300},
      {"HolesBand", holes, band, 300},
      {"Tiny", [](Random& r) { return scaled(noise(r), 1e-4f); },
       [](Random& r) {
         return IsoRange{1e-4f * r.between(-0.4f, 0), 1e-4f * r.between(0, 0.4f)};
       },
       300},
      {"Huge", [](Random& r) { return scaled(noise(r), 1e5f); },
       [](Random& r) {
         return IsoRange{1e5f * r.between(-0.4f, 0), 1e5f * r.between(0, 0.4f)};
       },
       300},
      {"Bigger",
       [](Random& r) {
         return uniform_noise({8, 9, 10}, r, -1, 1);
       },
       band, 60},
      {"Flat",
       [](Random& r) {
         return uniform_noise({2, 6, 3}, r, -1, 1);
       },
       band, 300},
      // Saddles of small whole numbers often lie on a whole level; samples on the level do not make a tie.
      {"SmallIntegers", [](Random& r) { return integer_noise(kSmall, r, -3, 3); }, whole_levels, 300, 1},
      {"ZeroesAndNearTies",
       [](Random& r) {
         return integer_noise({3, 3, 4}, r, -40, 40);
       },
       [](Random& r) {
         return IsoRange{0, static_cast<float>(r.integer(0, 30))};
       },
       300, 0.5},
  };
}

using Judge = Verdict (*)(const ScalarField&, IsoRange, BodyMode);

// Judges every stride-th field of the family and reports how many break the law, and how the first one does.
void expect_law(const Family& family, BodyMode mode, Judge judge, int stride = 1) {
  const std::uint64_t seed = test_seed(1);
  testing::Test::RecordProperty("seed", std::to_string(seed));
  Random random(seed);
  int judged = 0, broken = 0, undecided = 0;
  std::string first;
  for (int trial = 0; trial < family.fields; ++trial) {
    const ScalarField field = family.field(random);
    const IsoRange range = family.range(random);
    if (trial % stride != 0) continue;
    const Verdict verdict = judge(field, range, mode);
    ++judged;
    undecided += !verdict.decided;
    if (verdict.broken.empty()) continue;
    if (broken++ == 0)
      first = "seed " + std::to_string(seed) + ", field " + std::to_string(trial) + ": " + verdict.broken;
  }
  EXPECT_EQ(broken, 0) << "of " << judged << " fields. First: " << first;
  EXPECT_LE(undecided, family.most_undecided * judged);
  if (undecided > 0) std::cout << "undecided: " << undecided << " of " << judged << '\n';
}

class ExtractBody : public testing::TestWithParam<Family> {};

TEST_P(ExtractBody, SurfaceHasTheTopologyOfTheBody) {
  expect_law(GetParam(), BodyMode::exact, judge_closed_surface);
}

TEST_P(ExtractBody, SurfaceHasTheTopologyOfTheSampledBody) {
  expect_law(GetParam(), BodyMode::sampled, judge_closed_surface);
}

TEST_P(ExtractBody, SurfaceWithoutCapsIsManifoldWithBoundary) {
  expect_law(GetParam(), BodyMode::exact, judge_open_surface, 2);
  expect_law(GetParam(), BodyMode::sampled, judge_open_surface, 4);
}

TEST_P(ExtractBody, SurfaceKeepsItsTopologyInTheCodec) {
  expect_law(GetParam(), BodyMode::exact, judge_decoded_surface, 10);
}

INSTANTIATE_TEST_SUITE_P(Fields, ExtractBody, testing::ValuesIn(families()),
                         [](const auto& family) { return family.param.name; });

}  // namespace
}  // namespace geosis::test
