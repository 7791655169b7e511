#include "engine/missing/inverse_distance/inverse_distance.h"

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "engine/volume/brick_file.h"
#include "tests/engine/missing/gap_boxes.h"
#include "tests/support/random.h"

namespace geosis::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Survey {
  GridShape shape;
  std::vector<float> samples;

  std::size_t at(int i, int j, int k) const {
    return (static_cast<std::size_t>(i) * shape.crosslines + j) * shape.samples + k;
  }
  template <class IsMissing>
  void knock_out(const IsMissing& is_missing) {
    for_each_node(shape, [&](int i, int j, int k) {
      if (is_missing(i, j, k)) samples[at(i, j, k)] = kNan;
    });
  }
  std::unique_ptr<BrickedVolume> bricked() const { return make_bricked_volume(shape, samples); }
};

/// Layers with as much noise as signal: neighbouring cells differ.
Survey make_survey(GridShape shape, std::uint64_t seed) {
  Random random(seed);
  Survey survey{shape, {}};
  for_each_node(shape, [&](int i, int j, int k) {
    survey.samples.push_back(static_cast<float>(std::sin(0.5 * k + 0.2 * i) + std::cos(0.1 * j)) +
                             random.between(-1, 1));
  });
  return survey;
}

/// The sum over all samples, in double.
double by_all_samples(const Survey& survey, Vec3d steps, GridIndex node) {
  double values = 0, weights = 0;
  for_each_node(survey.shape, [&](int i, int j, int k) {
    const float sample = survey.samples[survey.at(i, j, k)];
    if (std::isnan(sample)) return;
    const double a = steps.x * (i - node.i), b = steps.y * (j - node.j), c = steps.z * (k - node.k);
    const double square = a * a + b * b + c * c, weight = 1 / (square * square * square);
    values += weight * static_cast<double>(sample);
    weights += weight;
  });
  return values / weights;
}

/// A box of the survey whose missing nodes are wanted. Known ones hold rubbish: they must not be used.
GapBox gap_of(const Survey& survey, const GridBox& nodes) {
  const GridShape shape{nodes.last.i - nodes.first.i + 1, nodes.last.j - nodes.first.j + 1,
                        nodes.last.k - nodes.first.k + 1};
  GapBox gap = known_box(shape, [](int, int, int) { return 1e6; });
  gap.samples.first = nodes.first;
  knock_out(gap, [&](int i, int j, int k) {
    return std::isnan(survey.samples[survey.at(nodes.first.i + i, nodes.first.j + j, nodes.first.k + k)]);
  });
  return gap;
}

GapBox filled(const Survey& survey, Vec3d steps, const GridBox& nodes, int threads = 1) {
  const auto volume = survey.bricked();
  NoProgress progress;
  const auto method = InverseDistanceFill::build(*volume, steps, threads, progress);
  GapBox gap = gap_of(survey, nodes);
  EXPECT_TRUE(method && method->fill(gap, progress));
  return gap;
}

/// The largest difference from the sum over all samples, for about `checks` of the wanted nodes of a box.
double far_field_error(const Survey& survey, Vec3d steps, const GridBox& nodes, int checks) {
  const GapBox gap = filled(survey, steps, nodes);
  std::vector<GridIndex> wanted;
  for_each_node(gap.samples.shape, [&](int i, int j, int k) {
    if (gap.state[gap.samples.at(i, j, k)] == NodeState::wanted) wanted.push_back({i, j, k});
  });
  const std::size_t stride = std::max<std::size_t>(1, wanted.size() / static_cast<std::size_t>(checks));
  double largest = 0;
  for (std::size_t n = 0; n < wanted.size(); n += stride) {
    const GridIndex at = wanted[n];
    const double value = static_cast<double>(gap.samples.value[gap.samples.at(at.i, at.j, at.k)]);
    const GridIndex node{nodes.first.i + at.i, nodes.first.j + at.j, nodes.first.k + at.k};
    largest = std::max(largest, std::abs(value - by_all_samples(survey, steps, node)));
  }
  return largest;
}

constexpr double kRange = 6;  // of make_survey's samples

TEST(InverseDistance, IsTheSumOverAllSamplesInAVolumeOfAFewCells) {
  Survey survey = make_survey({11, 9, 12}, 1);
  survey.knock_out([](int i, int j, int k) { return (i * 7 + j * 3 + k) % 5 == 0; });
  EXPECT_LT(far_field_error(survey, {1, 1, 1}, whole(survey.shape), 200), 2e-3);
}

TEST(InverseDistance, StaysWithinAPercentOfTheRangeAtScatteredPoints) {
  const std::uint64_t seed = test_seed(2);
  SCOPED_TRACE(testing::Message() << "GEOSIS_SEED=" << seed);
  for (const Vec3d steps : {Vec3d{1, 1, 1}, Vec3d{0.27, 0.13, 0.35}, Vec3d{0.05, 0.05, 1}}) {
    Survey survey = make_survey({70, 66, 80}, seed);
    Random random(seed);
    survey.knock_out([&](int, int, int) { return random.unit() < 0.02; });
    EXPECT_LT(far_field_error(survey, steps, {{10, 10, 10}, {59, 55, 69}}, 10), 0.01 * kRange)
        << steps.x << ' ' << steps.z;
  }
}

TEST(InverseDistance, StaysWithinAPercentOfTheRangeInTheMiddleOfHolesAndAtEdges) {
  for (const Vec3d steps : {Vec3d{1, 1, 1}, Vec3d{0.27, 0.13, 0.35}, Vec3d{0.05, 0.05, 1}}) {
    Survey survey = make_survey({70, 66, 80}, 3);
    survey.knock_out([](int i, int j, int) { return i > 20 && i < 45 && j > 18 && j < 50; });
    survey.knock_out([](int i, int j, int) { return i + j > 110; });
    EXPECT_LT(far_field_error(survey, steps, {{0, 0, 37}, {69, 65, 37}}, 16), 0.01 * kRange)
        << steps.x << ' ' << steps.z;
  }
}

TEST(InverseDistance, DoesNotDependOnTheBoxesOrThreads) {
  Survey survey = make_survey({70, 66, 80}, 4);
  survey.knock_out([](int i, int j, int k) { return (i * 31 + j * 17 + k * 7) % 41 == 0 || (i > 60 && j > 60); });
  const Vec3d steps{0.3, 0.2, 0.4};
  const GapBox all = filled(survey, steps, whole(survey.shape), 3);
  for (const GridBox& part : {GridBox{{0, 0, 0}, {9, 9, 9}}, GridBox{{5, 13, 31}, {69, 65, 48}}}) {
    const GapBox some = filled(survey, steps, part);
    for_each_node(some.samples.shape, [&](int i, int j, int k) {
      if (some.state[some.samples.at(i, j, k)] != NodeState::wanted) return;
      ASSERT_EQ(some.samples.value[some.samples.at(i, j, k)],
                all.samples.value[all.samples.at(i + part.first.i, j + part.first.j, k + part.first.k)]);
    });
  }
}

TEST(InverseDistance, StaysInTheRangeOfTheSamplesAtEveryScale) {
  for (const float scale : {std::numeric_limits<float>::max(), 1e-30f, std::numeric_limits<float>::denorm_min()}) {
    Survey survey = make_survey({12, 12, 40}, 5);
    for (std::size_t n = 0; n < survey.samples.size(); ++n) survey.samples[n] = n % 3 == 0 ? scale : -scale;
    survey.knock_out([](int i, int j, int k) { return (i + j + k) % 4 == 0; });
    const GapBox gap = filled(survey, {1, 1, 1}, whole(survey.shape));
    for (std::size_t at = 0; at < gap.state.size(); ++at) {
      if (gap.state[at] == NodeState::wanted) {
        ASSERT_LE(std::abs(gap.samples.value[at]), scale);
      }
    }
  }
}

TEST(InverseDistance, KeepsTheStartWhereNothingIsValidAnywhere) {
  Survey survey = make_survey({5, 5, 5}, 6);
  survey.knock_out([](int, int, int) { return true; });
  const GapBox gap = filled(survey, {1, 1, 1}, whole(survey.shape));
  for (const float value : gap.samples.value) EXPECT_EQ(value, 0);
}

TEST(InverseDistance, SaysWhenItIsCancelled) {
  Survey survey = make_survey({20, 20, 20}, 7);
  survey.knock_out([](int i, int, int) { return i == 3; });
  const auto volume = survey.bricked();
  CancelledAt at_once(0);
  const auto cancelled = InverseDistanceFill::build(*volume, {1, 1, 1}, 1, at_once);
  ASSERT_FALSE(cancelled);
  EXPECT_EQ(cancelled.error().code, ErrorCode::cancelled);
  NoProgress progress;
  const auto method = InverseDistanceFill::build(*volume, {1, 1, 1}, 1, progress);
  GapBox gap = gap_of(survey, whole(survey.shape));
  const auto filling = method->fill(gap, CancelledAt(2));
  ASSERT_FALSE(filling);
  EXPECT_EQ(filling.error().code, ErrorCode::cancelled);
}

}  // namespace
}  // namespace geosis::test
