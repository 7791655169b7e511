#include <iostream>
#include <string>

#include <gtest/gtest.h>

#include "tests/property/field_families.h"

// Laws of extract_body over families of random fields. GEOSIS_SEED=n runs them on other fields.

namespace geosis::test {
namespace {

// Judges every stride-th field of the family and reports how many break the law, and how the first one does.
void expect_law(const Family& family, BodyMode mode, Judge judge, int stride = 1) {
  const std::uint64_t seed = test_seed(1);
  testing::Test::RecordProperty("seed", std::to_string(seed));
  const Tally tally = judge_family(family, mode, judge, seed, family.fields, stride);
  EXPECT_EQ(tally.broken, 0) << "of " << tally.judged << " fields. First: " << tally.first_broken;
  EXPECT_LE(tally.undecided, family.most_undecided * tally.judged);
  if (tally.undecided > 0) std::cout << "undecided: " << tally.undecided << " of " << tally.judged << '\n';
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
