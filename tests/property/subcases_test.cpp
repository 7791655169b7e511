#include "tests/property/subcases.h"

#include <iostream>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "tests/property/surface_laws.h"
#include "tests/support/body_oracle.h"

// Every subcase of a cell, its complement, and all symmetries of the cube.

namespace geosis::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

template <class Visit>
void each_image(const Visit& visit) {
  for (const Subcase& subcase : subcases()) {
    for (const bool negated : {false, true}) {
      for (int symmetry = 0; symmetry < 48; ++symmetry) visit(subcase, negated, symmetry);
    }
  }
}

struct Tally {
  int judged = 0, undecided = 0;

  void add(const Verdict& verdict, const std::string& what) {
    ASSERT_EQ(verdict.broken, "") << what;
    ++judged;
    undecided += !verdict.decided;
  }
};

TEST(Subcases, AreWhatTheirNamesSay) {
  Random random(1);
  each_image([&](const Subcase& subcase, bool negated, int symmetry) {
    const SurfaceTopology expected =
        expected_open_surface(embedded(subcase, symmetry, negated, 2, random), {0, kInf}, BodyMode::exact);
    ASSERT_TRUE(expected.decided) << subcase.name;
    ASSERT_EQ(expected.euler, subcase.euler) << subcase.name << (negated ? " negated" : "");
  });
}

TEST(Subcases, AloneHaveTheTopologyOfTheBody) {
  Random random(1);
  Tally tally;
  each_image([&](const Subcase& subcase, bool negated, int symmetry) {
    const ScalarField field = embedded(subcase, symmetry, negated, 2, random);
    const std::string what = std::string(subcase.name) + ", symmetry " + std::to_string(symmetry);
    for (const IsoRange range : {IsoRange{0, kInf}, IsoRange{-kInf, 0}}) {
      tally.add(judge_closed_surface(field, range, BodyMode::exact), what);
      tally.add(judge_open_surface(field, range, BodyMode::exact), what);
    }
    tally.add(judge_closed_surface(field, {0, kInf}, BodyMode::sampled), what);
  });
  EXPECT_EQ(tally.undecided, 0) << "of " << tally.judged;
}

TEST(Subcases, AmongNoiseHaveTheTopologyOfTheBody) {
  const std::uint64_t seed = test_seed(33);
  Random random(seed);
  Tally tally;
  each_image([&](const Subcase& subcase, bool negated, int symmetry) {
    const ScalarField field = embedded(subcase, symmetry, negated, 4 + symmetry % 3, random);
    const std::string what =
        std::string(subcase.name) + ", symmetry " + std::to_string(symmetry) + ", seed " + std::to_string(seed);
    tally.add(judge_closed_surface(field, {0, kInf}, BodyMode::exact), what);
    if (symmetry % 4 == 0) tally.add(judge_decoded_surface(field, {0, kInf}, BodyMode::exact), what);
  });
  std::cout << "seed " << seed << ", undecided " << tally.undecided << " of " << tally.judged << '\n';
  EXPECT_LE(tally.undecided, 0.01 * tally.judged);
}

}  // namespace
}  // namespace geosis::test
