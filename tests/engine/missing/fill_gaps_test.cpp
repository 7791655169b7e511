#include "engine/missing/fill_gaps.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <set>
#include <vector>

#include "engine/missing/brick_nodes.h"
#include "engine/missing/gaps/survey_scan.h"
#include "engine/missing/linear_fill.h"
#include "tests/engine/missing/gappy_fields.h"

namespace geosis {
namespace {

using test::for_each_node;
using test::ScalarField;

constexpr GapLimits kTiny{.small_gap = 3, .small_tile = 8, .whole_box = 600, .tile = 9, .overlap = 2};

/// Border traces stay valid, so every gap is inside the outline.
ScalarField gappy_field(GridShape shape, std::uint64_t seed) {
  test::Random random(seed);
  const ScalarField whole = test::uniform_noise(shape, random, 10, 11);
  ScalarField field = test::with_holes(whole, random, 0.03);
  field = test::without(std::move(field), {{3, 3, 5}, {shape.inlines - 4, shape.crosslines / 2, shape.samples - 9}});
  field = test::without_trace(std::move(field), 2, shape.crosslines - 3);
  for_each_node(shape, [&](GridIndex n) {
    if (n.i == 0 || n.j == 0 || n.i + 1 == shape.inlines || n.j + 1 == shape.crosslines) field.at(n) = whole.at(n);
  });
  return field;
}

ScalarField solve(const ScalarField& field, const GapSolver& solver, const GapLimits& limits, int threads,
                  std::optional<BitLines> kept = std::nullopt) {
  const auto volume = test::volume_of(field);
  NoProgress unwatched;
  const auto scan = scan_survey(*volume, 1, unwatched);
  const std::vector<std::uint8_t> inside(
      static_cast<std::size_t>(field.shape.inlines) * static_cast<std::size_t>(field.shape.crosslines), 1);
  BitLines nodes(inside.size(), field.shape.samples);
  for (std::size_t trace = 0; trace < inside.size(); ++trace) {
    std::ranges::transform(scan->valid.line(trace), nodes.line(trace).begin(),
                           [](std::uint64_t word) { return ~word; });
    nodes.line(trace).back() &= nodes.last_word();
  }
  const BitLines& records = kept ? *kept : nodes;
  const AxisBarycentre barycentre(scan->views, scan->valid, scan->step_lengths, inside);
  const BrickLayout& layout = scan->views.layout();
  std::vector<std::uint32_t> counts(layout.brick_count());
  for (std::size_t brick = 0; brick < counts.size(); ++brick) counts[brick] = count_nodes(layout, brick, records);
  auto writer = FillWriter::create(*volume, counts, std::nullopt);
  for (std::size_t brick = 0; brick < counts.size(); ++brick)
    fill_brick(barycentre, records, layout, brick, *writer, unwatched);
  const auto solved = fill_gaps({*volume, barycentre, nodes}, solver, limits, *writer, threads, unwatched, 0, 1);
  EXPECT_TRUE(solved);
  for (std::size_t brick = 0; brick < counts.size(); ++brick) writer->index(brick, true);
  const auto filled = std::move(*writer).finish(records.count());
  return test::samples_of(**filled);
}

void expect_same(const ScalarField& a, const ScalarField& b) {
  for (std::size_t n = 0; n < a.samples.size(); ++n) ASSERT_EQ(a.samples[n], b.samples[n]) << n;
}

/// Visits the wanted nodes of a box: visit(node of the volume, place in the box).
template <class Visit>
void for_wanted(GapBox& gap, const Visit& visit) {
  std::size_t at = 0;
  for_each_node(gap.samples.shape, [&](GridIndex n) {
    const GridIndex& first = gap.samples.first;
    if (gap.state[at] == NodeState::wanted) visit(GridIndex{first.i + n.i, first.j + n.j, first.k + n.k}, at);
    ++at;
  });
}

TEST(FillGaps, StartsFromTheAxisBarycentre) {
  const ScalarField field = gappy_field({20, 22, 70}, 1);
  const GapSolver idle = [](GapBox&, Progress&) { return Result<void>(); };
  expect_same(solve(field, idle, kTiny, 1), test::fill(field));
}

TEST(FillGaps, KeepsTheValueOfEveryNodeInEveryBrick) {
  const ScalarField field = gappy_field({20, 68, 130}, 2);
  const auto value = [](GridIndex n) { return static_cast<float>(10.1 + 0.03 * n.i + 0.005 * n.j + 0.001 * n.k); };
  const GapSolver naming = [&](GapBox& gap, Progress&) {
    for_wanted(gap, [&](GridIndex n, std::size_t at) { gap.samples.value[at] = value(n); });
    return Result<void>();
  };
  for (const GapLimits& limits : {kTiny, GapLimits{}}) {
    const ScalarField filled = solve(field, naming, limits, 2);
    for_each_node(field.shape, [&](GridIndex n) {
      ASSERT_FLOAT_EQ(filled.at(n), std::isnan(field.at(n)) ? std::clamp(value(n), 10.0f, 11.0f) : field.at(n));
    });
  }
}

TEST(FillGaps, ClampsToTheSamplesAndIgnoresWhatIsNotFinite) {
  const ScalarField field = gappy_field({12, 12, 30}, 3);
  const GapSolver wild = [](GapBox& gap, Progress&) {
    for_wanted(gap, [&](GridIndex n, std::size_t at) { gap.samples.value[at] = n.k % 2 == 0 ? test::kMissing : 1e9f; });
    return Result<void>();
  };
  const ScalarField filled = solve(field, wild, kTiny, 1), start = test::fill(field);
  const float largest = *std::ranges::max_element(filled.samples);
  EXPECT_LT(largest, 11);
  for_each_node(field.shape, [&](GridIndex n) {
    if (std::isnan(field.at(n))) {
      ASSERT_EQ(filled.at(n), n.k % 2 == 0 ? start.at(n) : largest);
    }
  });
}

/// Law: whatever shares a stencil with a wanted node is in its box: known, wanted, or outside the volume.
TEST(FillGaps, SurroundsWantedNodesWithAllTheirStencils) {
  const ScalarField field = gappy_field({24, 26, 60}, 4);
  const GapSolver looking = [&](GapBox& gap, Progress&) {
    const SampleBox& box = gap.samples;
    for_wanted(gap, [&](GridIndex n, std::size_t at) {
      EXPECT_TRUE(std::isfinite(box.value[at]));
      for (const auto& [a, b, c] : {std::array{2, 0, 0},
                                    {-2, 0, 0},
                                    {0, 2, 0},
                                    {0, -2, 0},
                                    {0, 0, 2},
                                    {0, 0, -2},
                                    {1, 1, 0},
                                    {-1, 1, 0},
                                    {0, 1, -1},
                                    {1, 0, 1}}) {
        const GridIndex m{n.i + a, n.j + b, n.k + c};
        if (m.i < 0 || m.j < 0 || m.k < 0 || m.i >= field.shape.inlines || m.j >= field.shape.crosslines ||
            m.k >= field.shape.samples)
          continue;
        const std::size_t other = box.at(m.i - box.first.i, m.j - box.first.j, m.k - box.first.k);
        EXPECT_NE(gap.state[other], NodeState::absent);
        EXPECT_TRUE(std::isfinite(box.value[other]));
      }
    });
    return Result<void>();
  };
  solve(field, looking, kTiny, 1);
  solve(field, looking, {}, 1);
}

/// A few sweeps of averaging: the result depends on everything that a box holds.
Result<void> relax(GapBox& gap, Progress&) {
  const GridShape& shape = gap.samples.shape;
  std::vector<float>& value = gap.samples.value;
  const std::size_t step[] = {static_cast<std::size_t>(shape.crosslines * shape.samples),
                              static_cast<std::size_t>(shape.samples), 1};
  for (int sweep = 0; sweep < 5; ++sweep)
    for_wanted(gap, [&](GridIndex n, std::size_t at) {
      float sum = 0, count = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const std::int32_t place = n[axis] - gap.samples.first[axis];
        const auto add = [&](std::size_t other) {
          if (gap.state[other] == NodeState::absent) return;
          sum += value[other];
          ++count;
        };
        if (place > 0) add(at - step[axis]);
        if (place + 1 < shape[axis]) add(at + step[axis]);
      }
      if (count > 0) value[at] = sum / count;
    });
  return {};
}

TEST(FillGaps, DoesNotDependOnThreads) {
  const ScalarField field = gappy_field({40, 42, 70}, 5);
  const ScalarField one = solve(field, relax, kTiny, 1);
  for (const int threads : {2, 8}) expect_same(solve(field, relax, kTiny, threads), one);
}

TEST(FillGaps, GivesLaterTilesTheValuesOfEarlierOnes) {
  const ScalarField field = gappy_field({40, 42, 50}, 6);
  std::mutex lock;
  std::map<std::size_t, std::set<float>> values;  // known values that boxes saw in missing nodes
  const GapSolver marking = [&](GapBox& gap, Progress&) {
    const std::lock_guard guard(lock);
    std::size_t at = 0;
    for_each_node(gap.samples.shape, [&](GridIndex n) {
      const GridIndex& first = gap.samples.first;
      const std::size_t node = field.index({first.i + n.i, first.j + n.j, first.k + n.k});
      if (gap.state[at] == NodeState::wanted) gap.samples.value[at] = 10.5f;
      if (gap.state[at] == NodeState::known && std::isnan(field.samples[node]))
        values[node].insert(gap.samples.value[at]);
      ++at;
    });
    return Result<void>();
  };
  const ScalarField start = test::fill(field);
  solve(field, marking, kTiny, 2);
  std::size_t decided = 0;
  for (const auto& [node, seen] : values)
    for (const float value : seen) {
      EXPECT_TRUE(value == 10.5f || value == start.samples[node]) << value;
      decided += value == 10.5f;
    }
  EXPECT_GT(decided, 1000u);
}

TEST(FillGaps, PassesOnWhatASolverFailsWith) {
  const ScalarField field = gappy_field({12, 12, 30}, 7);
  const auto volume = test::volume_of(field);
  NoProgress unwatched;
  const auto scan = scan_survey(*volume, 1, unwatched);
  const std::vector<std::uint8_t> inside(144, 1);
  BitLines nodes(144, 30);
  nodes.line(40)[0] = 1;
  const AxisBarycentre barycentre(scan->views, scan->valid, scan->step_lengths, inside);
  auto writer = FillWriter::create(*volume, std::vector<std::uint32_t>(volume->brick_count()), std::nullopt);
  const GapSolver failing = [](GapBox&, Progress&) { return Result<void>(Error{ErrorCode::limit_exceeded, "full"}); };
  const auto solved = fill_gaps({*volume, barycentre, nodes}, failing, {}, *writer, 2, unwatched, 0, 1);
  ASSERT_FALSE(solved);
  EXPECT_EQ(solved.error().code, ErrorCode::limit_exceeded);
}

}  // namespace
}  // namespace geosis
