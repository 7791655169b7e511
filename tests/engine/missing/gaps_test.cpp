#include "engine/missing/gaps/gaps.h"

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <map>
#include <vector>

#include "engine/missing/gaps/gap_jobs.h"
#include "tests/engine/missing/gappy_fields.h"

namespace geosis {
namespace {

using test::for_each_node;
using test::ScalarField;

BitLines missing_nodes(const ScalarField& field) {
  BitLines nodes(static_cast<std::size_t>(field.shape.inlines) * static_cast<std::size_t>(field.shape.crosslines),
                 field.shape.samples);
  for_each_node(field.shape, [&](GridIndex n) {
    if (std::isnan(field.at(n)))
      nodes.line(static_cast<std::size_t>(n.i * field.shape.crosslines + n.j))[static_cast<std::size_t>(n.k / 64)] |=
          std::uint64_t{1} << n.k % 64;
  });
  return nodes;
}

Gaps gaps_of(const ScalarField& field) {
  NoProgress unwatched;
  return *find_gaps(field.shape, missing_nodes(field), unwatched);
}

/// Gap number of each node, -1 = none.
std::vector<std::int64_t> labels_of(const Gaps& gaps) {
  std::vector<std::int64_t> labels(static_cast<std::size_t>(gaps.shape.count()), -1);
  for (std::size_t trace = 0; trace + 1 < gaps.first_run.size(); ++trace)
    for (std::uint32_t run = gaps.first_run[trace]; run < gaps.first_run[trace + 1]; ++run)
      for (std::int32_t k = gaps.runs[run].first; k <= gaps.runs[run].last; ++k)
        labels[trace * static_cast<std::size_t>(gaps.shape.samples) + static_cast<std::size_t>(k)] = gaps.gap_of[run];
  return labels;
}

/// By flooding, over all offsets that share a stencil.
std::vector<std::int64_t> flooded_labels(const ScalarField& field) {
  std::vector<std::int64_t> labels(field.samples.size(), -1);
  std::int64_t next = 0;
  for_each_node(field.shape, [&](GridIndex seed) {
    if (!std::isnan(field.at(seed)) || labels[field.index(seed)] >= 0) return;
    std::deque<GridIndex> open{seed};
    labels[field.index(seed)] = next;
    while (!open.empty()) {
      const GridIndex n = open.front();
      open.pop_front();
      for (std::int32_t a = -2; a <= 2; ++a)
        for (std::int32_t b = -2; b <= 2; ++b)
          for (std::int32_t c = -2; c <= 2; ++c) {
            const GridIndex m{n.i + a, n.j + b, n.k + c};
            const int longest = std::max({std::abs(a), std::abs(b), std::abs(c)});
            const int axes = (a != 0) + (b != 0) + (c != 0);
            const bool coupled = axes == 1 || (axes == 2 && longest == 1);
            if (!coupled || m.i < 0 || m.j < 0 || m.k < 0 || m.i >= field.shape.inlines ||
                m.j >= field.shape.crosslines || m.k >= field.shape.samples)
              continue;
            if (!std::isnan(field.at(m)) || labels[field.index(m)] >= 0) continue;
            labels[field.index(m)] = next;
            open.push_back(m);
          }
    }
    ++next;
  });
  return labels;
}

TEST(FindGaps, AgreesWithFlooding) {
  const std::uint64_t seed = test::test_seed(31);
  for (std::uint64_t round = 0; round < 30; ++round) {
    SCOPED_TRACE(testing::Message() << "seed " << seed + round);
    test::Random random(seed + round);
    const GridShape shape{random.integer(1, 9), random.integer(1, 9), random.integer(1, 140)};
    const ScalarField field = test::with_holes(ScalarField(shape), random, 0.25 * random.unit());
    const Gaps gaps = gaps_of(field);
    ASSERT_EQ(labels_of(gaps), flooded_labels(field));
    std::vector<std::int64_t> nodes(gaps.gaps.size());
    for (const std::int64_t label : labels_of(gaps))
      if (label >= 0) ++nodes[static_cast<std::size_t>(label)];
    for (std::size_t gap = 0; gap < nodes.size(); ++gap) EXPECT_EQ(gaps.gaps[gap].nodes, nodes[gap]);
  }
}

/// Law: every node of a gap is in the core of exactly one job of its group.
void expect_covered_once(const ScalarField& field, const GapLimits& limits) {
  const Gaps gaps = gaps_of(field);
  const GapPlan plan = plan_gap_jobs(gaps, limits);
  const auto labels = labels_of(gaps);
  EXPECT_TRUE(std::ranges::is_sorted(plan.jobs, {}, &GapJob::wave));
  std::vector<int> covered(labels.size());
  for (const GapJob& job : plan.jobs)
    for (std::int32_t i = job.core.first.i; i <= job.core.last.i; ++i)
      for (std::int32_t j = job.core.first.j; j <= job.core.last.j; ++j)
        for (std::int32_t k = job.core.first.k; k <= job.core.last.k; ++k) {
          const std::size_t n = field.index({i, j, k});
          if (labels[n] < 0 || plan.group_of[static_cast<std::size_t>(labels[n])] != job.group) continue;
          ++covered[n];
          EXPECT_EQ(job.wave_of({i, j, k}), job.wave);
        }
  for (std::size_t n = 0; n < labels.size(); ++n) ASSERT_EQ(covered[n], labels[n] >= 0);
}

TEST(PlanGapJobs, CoversEveryNodeOnce) {
  test::Random random(37);
  for (const double missing : {0.01, 0.05, 0.3})
    expect_covered_once(test::with_holes(ScalarField(GridShape{20, 30, 40}), random, missing),
                        {.small_gap = 6, .small_tile = 8, .whole_box = 1000, .tile = 7, .overlap = 2});
}

TEST(PlanGapJobs, KeepsBoxesWithinTheirBounds) {
  const ScalarField hole = test::without(ScalarField(GridShape{40, 50, 60}), {{2, 2, 2}, {37, 47, 57}});
  const GapLimits limits{.small_gap = 6, .small_tile = 8, .whole_box = 1000, .tile = 12, .overlap = 3};
  for (const GapJob& job : plan_gap_jobs(gaps_of(hole), limits).jobs) {
    EXPECT_GE(job.wave, kFirstTileWave);
    const GridShape side = shape_of(job.solved);
    for (int axis = 0; axis < 3; ++axis) EXPECT_LE(side[axis], 12 + 2 * 3);
  }
  const GapPlan whole = plan_gap_jobs(gaps_of(hole), {});
  ASSERT_EQ(whole.jobs.size(), 1u);
  EXPECT_EQ(whole.jobs[0].wave, kWholeWave);
}

TEST(PlanGapJobs, SolvesSmallGapsOfATileTogether) {
  test::Random random(41);
  const GapPlan plan = plan_gap_jobs(gaps_of(test::with_holes(ScalarField(GridShape{64, 64, 64}), random, 0.005)), {});
  EXPECT_EQ(plan.jobs.size(), 1u);
  EXPECT_GT(plan.group_of.size(), 500u);
}

}  // namespace
}  // namespace geosis
