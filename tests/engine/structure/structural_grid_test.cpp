#include "engine/structure/structural_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/volume/brick_file.h"
#include "engine/volume/synthetic_survey.h"
#include "tests/support/layer_errors.h"
#include "tests/support/layered_truth.h"
#include "tests/support/random.h"

namespace geosis {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

class CancelAfter final : public Progress {
 public:
  explicit CancelAfter(int reports) : left_(reports) {}
  void report(const char*, double) override { --left_; }
  bool cancelled() const override { return left_ < 0; }

 private:
  int left_;
};

Result<StructuralGrid> grid_of(const test::ScalarField& field, const StructureOptions& options = {}) {
  NoProgress progress;
  const auto volume = make_bricked_volume(field.shape, field.samples);
  return build_structural_grid({*volume}, options, progress);
}

/// What every structural grid must hold, whatever it was made from.
void expect_whole(const StructuralGrid& grid, GridShape shape) {
  ASSERT_EQ(grid.paths.shape(), shape);
  ASSERT_TRUE(grid.paths.is_sound());
  std::vector<std::int32_t> path(static_cast<std::size_t>(grid.paths.layers()));
  for (std::int32_t i = 0; i < shape.inlines; ++i) {
    for (std::int32_t j = 0; j < shape.crosslines; ++j) {
      grid.paths.get(i, j, path);
      ASSERT_EQ(path.front(), 0);
      ASSERT_EQ(path.back(), shape.samples - 1);
      for (std::size_t u = 1; u < path.size(); ++u) {
        ASSERT_TRUE(path[u] - path[u - 1] == 0 || path[u] - path[u - 1] == 1);
      }
    }
  }
}

TEST(StructuralGrid, OfAnyFieldKeepsEverySampleInOrder) {
  const std::uint64_t seed = test::test_seed(21);
  SCOPED_TRACE("seed " + std::to_string(seed));
  test::Random random(seed);
  for (int round = 0; round < 24; ++round) {
    const GridShape shape = {random.integer(1, 14), random.integer(1, 14), random.integer(1, 90)};
    test::ScalarField field(shape);
    const double roughness = random.unit(), gaps = round % 3 == 0 ? random.unit() : 0;
    for (float& sample : field.samples) {
      sample = random.unit() < roughness ? random.between(-3, 3) : 1.0f;
      if (random.unit() < gaps) sample = kMissing;
    }
    const auto grid = grid_of(field, {.layer_spacing = round % 4});
    if (!grid) {
      EXPECT_EQ(grid.error().code, ErrorCode::limit_exceeded) << grid.error().message;
      continue;
    }
    expect_whole(*grid, shape);
  }
}

struct TruthCase {
  test::Layering layering;
  double dip_error, layer_error, neighbours;
};

TEST(StructuralGrid, FollowsReflectorsOfWhichTheTruthIsKnown) {
  // One and a half times what a prototype reached on surveys of this kind.
  const TruthCase cases[] = {{test::Layering::gentle, 0.030, 0.21, 0.999},
                             {test::Layering::steep, 0.084, 0.75, 0.995},
                             {test::Layering::growth, 0.026, 0.18, 0.999},
                             {test::Layering::faulted, 10, 0.84, 0.955}};
  for (const TruthCase& expected : cases) {
    SCOPED_TRACE(static_cast<int>(expected.layering));
    const test::LayeredTruth truth({.shape = {100, 100, 120}, .layering = expected.layering});
    const auto field = truth.samples();
    const auto volume = make_bricked_volume(field.shape, field.samples);
    NoProgress progress;
    auto measured = measure_dips({*volume}, 2, progress);
    ASSERT_TRUE(measured);
    ASSERT_TRUE(scan_agreements(
        *volume, measured->scan, 2, progress, [](double) {}, measured->field));
    const auto layers = lay_layers(measured->field, {.threads = 2}, progress);
    ASSERT_TRUE(layers);
    EXPECT_LT(test::dip_error(truth, measured->field), expected.dip_error);
    const test::LayerErrors errors = test::layer_errors(truth, *layers);
    EXPECT_LT(errors.rms, expected.layer_error);
    EXPECT_GE(errors.neighbours, expected.neighbours);
    EXPECT_GT(test::layer_errors(truth, test::axis_depths(field.shape)).rms, 5 * errors.rms);
  }
}

TEST(StructuralGrid, FollowsReflectorsBeyondHalfThePeriodATrace) {
  for (const double dip : {-8.0, 6.0}) {
    const test::LayeredTruth truth({.shape = {24, 24, 160}, .layering = test::Layering::plane, .dip = dip});
    const auto field = truth.samples();
    const auto volume = make_bricked_volume(field.shape, field.samples);
    NoProgress progress;
    auto measured = measure_dips({*volume}, 2, progress);
    ASSERT_TRUE(measured);
    EXPECT_TRUE(measured->report.warped);
    EXPECT_NEAR(measured->report.dips[0].median, std::abs(dip), 0.05);
    EXPECT_LT(test::dip_error(truth, measured->field), 0.4);
    ASSERT_TRUE(scan_agreements(
        *volume, measured->scan, 2, progress, [](double) {}, measured->field));
    const auto layers = lay_layers(measured->field, {.threads = 2}, progress);
    ASSERT_TRUE(layers);
    EXPECT_LT(test::layer_errors(truth, *layers).rms, 0.5) << dip;
    expect_whole(*grid_of(field, {.threads = 2}), field.shape);
  }
}

TEST(StructuralGrid, WarpsAroundMissingTraces) {
  const test::LayeredTruth truth({.shape = {24, 24, 120}, .layering = test::Layering::plane, .dip = 6});
  auto field = truth.samples();
  test::for_each_node(field.shape, [&](GridIndex n) {
    if (n.i + n.j < 10 || (n.i == 12 && n.j == 12)) field.at(n) = kMissing;
  });
  const auto grid = grid_of(field, {.threads = 2});
  ASSERT_TRUE(grid) << grid.error().message;
  expect_whole(*grid, field.shape);
  EXPECT_TRUE(grid->report.dips.warped);
  EXPECT_NEAR(grid->report.dips.dips[0].median, 6, 0.1);
}

class StructuralGridOf : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Dips, StructuralGridOf, testing::Values(0.0, 6.0));  // steep folds; a warped plane

TEST_P(StructuralGridOf, OneFieldIsTheSameForAnyNumberOfThreadsAndAnyScale) {
  const bool is_plane = GetParam() > 0;
  const test::LayeredTruth truth({.shape = {is_plane ? 19 : 40, is_plane ? 17 : 37, 90},
                                  .layering = is_plane ? test::Layering::plane : test::Layering::steep,
                                  .dip = GetParam()});
  auto field = truth.samples();
  const auto one = grid_of(field, {.threads = 1});
  const auto three = grid_of(field, {.threads = 3});
  for (float& sample : field.samples) sample *= 64;
  const auto scaled = grid_of(field, {.threads = 2});
  ASSERT_TRUE(one && three && scaled);
  for (const auto* other : {&*three, &*scaled}) {
    ASSERT_EQ(one->paths.layers(), other->paths.layers());
    EXPECT_TRUE(std::ranges::equal(one->paths.words(), other->paths.words()));
    EXPECT_EQ(one->agreement, other->agreement);
    EXPECT_EQ(one->report, other->report);
  }
}

TEST(StructuralGrid, OfFlatReflectorsIsTheAxisGrid) {
  const test::LayeredTruth truth({.shape = {20, 20, 80}, .layering = test::Layering::plane, .dip = 0, .noise = 0});
  const auto grid = grid_of(truth.samples());
  ASSERT_TRUE(grid);
  EXPECT_EQ(grid->paths.layers(), 80);
  EXPECT_EQ(grid->report.unreliable_share, 0);
}

TEST(StructuralGrid, CarriesLayersThroughHolesAndBeyondTheSurveysOutline) {
  const test::LayeredTruth truth({.shape = {60, 60, 100}, .layering = test::Layering::gentle});
  const auto full = truth.samples();
  auto field = full;
  test::for_each_node(field.shape, [&](GridIndex n) {
    const bool is_outside = n.i + n.j < 24 || n.i > 52;
    const bool is_in_hole = n.i > 25 && n.i < 36 && n.j > 30 && n.j < 41;
    if (is_outside || is_in_hole) field.at(n) = kMissing;
  });
  const auto with_gaps = grid_of(field, {.threads = 2});
  ASSERT_TRUE(with_gaps);
  expect_whole(*with_gaps, field.shape);
  // In the middle of the hole a layer lies where the truth says, seen from the hole's rim.
  std::vector<std::int32_t> rim(static_cast<std::size_t>(with_gaps->paths.layers())), middle(rim.size());
  with_gaps->paths.get(25, 35, rim);
  with_gaps->paths.get(30, 35, middle);
  for (std::size_t u = 0; u < rim.size(); ++u) {
    if (rim[u] < 20 || rim[u] > 80) continue;
    EXPECT_NEAR(truth.layer_at(25, 35, rim[u]), truth.layer_at(30, 35, middle[u]), 2) << u;
  }
  EXPECT_EQ(with_gaps->agreement[0], 0);
  EXPECT_LT(with_gaps->report.unreliable_share, 0.05);
}

TEST(StructuralGrid, IsUnreliableWhereAFaultCuts) {
  const test::LayeredTruth truth({.shape = {60, 60, 100}, .layering = test::Layering::faulted});
  const auto grid = grid_of(truth.samples(), {.threads = 2});
  ASSERT_TRUE(grid);
  double at_fault = 0, elsewhere = 0, faults = 0, others = 0;
  for (std::int32_t i = 8; i + 8 < 60; ++i) {
    for (std::int32_t j = 8; j + 8 < 60; ++j) {
      bool is_cut = false, is_far = true;
      for (int d = -6; d <= 6; ++d) {
        for (int e = -6; e <= 6; ++e) {
          if (truth.block(i + d, j + e) == truth.block(i, j)) continue;
          is_far = false;
          if (std::abs(d) + std::abs(e) == 1) is_cut = true;
        }
      }
      for (std::size_t m = 4; m < 21; ++m) {
        const double agreement = grid->agreement[(static_cast<std::size_t>(i) * 60 + j) * 25 + m];
        if (is_cut) at_fault += agreement, ++faults;
        if (is_far) elsewhere += agreement, ++others;
      }
    }
  }
  EXPECT_LT(at_fault / faults / 255, 0.9);
  EXPECT_GT(elsewhere / others / 255, 0.95);
}

TEST(StructuralGrid, RefusesMoreLayersThanTheLimit) {
  const test::LayeredTruth truth({.shape = {60, 4, 40}, .layering = test::Layering::plane, .dip = 3});
  const auto grid = grid_of(truth.samples(), {.most_layers_a_sample = 2});
  ASSERT_FALSE(grid);
  EXPECT_EQ(grid.error().code, ErrorCode::limit_exceeded);
  EXPECT_NE(grid.error().message.find("at most 80"), std::string::npos) << grid.error().message;
}

TEST(StructuralGrid, StopsWhenCancelled) {
  const test::LayeredTruth truth({.shape = {40, 20, 60}});
  const auto field = truth.samples();
  const auto volume = make_bricked_volume(field.shape, field.samples);
  for (const int reports : {0, 1, 3, 6, 40}) {
    CancelAfter progress(reports);
    const auto grid = build_structural_grid({*volume}, {}, progress);
    ASSERT_FALSE(grid) << reports;
    EXPECT_EQ(grid.error().code, ErrorCode::cancelled);
  }
}

TEST(StructuralGrid, ReportsPeriodAndDips) {
  const test::LayeredTruth truth({.shape = {40, 40, 160}, .layering = test::Layering::plane, .dip = 2, .noise = 0});
  const auto grid = grid_of(truth.samples());
  ASSERT_TRUE(grid);
  EXPECT_NEAR(grid->report.dips.period, 14, 1.5);
  EXPECT_NEAR(grid->report.dips.dips[0].median, 2, 0.05);
  EXPECT_NEAR(grid->report.dips.dips[1].p95, 0, 0.05);
}

}  // namespace
}  // namespace geosis
