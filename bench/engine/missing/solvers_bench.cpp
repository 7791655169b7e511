#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>

#include <benchmark/benchmark.h>

#include "engine/base/progress.h"
#include "engine/missing/inverse_distance/inverse_distance.h"
#include "engine/missing/plate/plate_gaps.h"
#include "engine/missing/plate/thin_plate.h"
#include "engine/missing/plate/wide_plate.h"
#include "engine/volume/brick_file.h"
#include "tests/engine/missing/gap_boxes.h"
#include "tests/support/random.h"

namespace geosis {
namespace {

/// Layers that dip and bend, with a little noise.
GapBox layers_box(GridShape shape) {
  test::Random random(1);
  return test::known_box(shape, [&](int i, int j, int k) {
    return std::sin(0.45 * k + 0.11 * i - 0.07 * j) + 0.3 * std::cos(0.021 * i * j / 40) + 0.05 * random.unit();
  });
}

void set_rates(benchmark::State& state, const GapBox& gap) {
  std::int64_t wanted = 0;
  for (const NodeState one : gap.state) wanted += one == NodeState::wanted;
  state.counters["wanted"] = static_cast<double>(wanted);
  state.counters["per_wanted"] = benchmark::Counter(
      static_cast<double>(wanted), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void run(benchmark::State& state, const GapBox& start, const Vec3d& steps) {
  NoProgress progress;
  for (auto _ : state) {
    state.PauseTiming();
    GapBox gap = start;
    state.ResumeTiming();
    fill_thin_plate(gap, steps, {}, progress);
    benchmark::DoNotOptimize(gap.samples.value.data());
  }
  set_rates(state, start);
}

/// A cubic gap. Arguments: nodes an axis, 100 c_k.
void BM_WideGap(benchmark::State& state) {
  const auto size = static_cast<int>(state.range(0));
  GapBox gap = layers_box({size + 4, size + 4, size + 4});
  test::knock_out(gap, test::cube_gap(size));
  const Vec3d steps{1, 1, 1 / std::sqrt(static_cast<double>(state.range(1)) / 100)};
  run(state, gap, steps);
  const PlateGaps gaps = find_plate_gaps(gap, NoProgress());
  const Vec3d weights{1, 1, static_cast<double>(state.range(1)) / 100};
  state.counters["iterations"] = fill_wide_plate(gap, gaps.nodes, weights, {}, NoProgress()).iterations;
}
BENCHMARK(BM_WideGap)
    ->ArgNames({"nodes", "c_k"})
    ->ArgsProduct({{20, 40, 60, 100}, {100, 15, 1}})
    ->Unit(benchmark::kMillisecond);

/// Scattered single nodes in a box. Arguments: nodes an axis, per mille missing.
void BM_Points(benchmark::State& state) {
  const auto size = static_cast<int>(state.range(0));
  test::Random random(2);
  GapBox gap = layers_box({size, size, size});
  const double share = static_cast<double>(state.range(1)) / 1000;
  test::knock_out(gap, [&](int, int, int) { return random.unit() < share; });
  run(state, gap, {1, 1, 2.5});
}
BENCHMARK(BM_Points)
    ->ArgNames({"nodes", "per_mille"})
    ->ArgsProduct({{68, 256}, {10, 50, 200}})
    ->Unit(benchmark::kMillisecond);

/// Dead traces in one box of 64 x 64 x 256. Argument: percent missing.
void BM_Traces(benchmark::State& state) {
  test::Random random(3);
  GapBox gap = layers_box({64, 64, 256});
  std::array<bool, 64 * 64> is_dead{};
  for (bool& dead : is_dead) dead = random.unit() < static_cast<double>(state.range(0)) / 100;
  test::knock_out(gap, [&](int i, int j, int) { return is_dead[i * 64 + j]; });
  run(state, gap, {1, 1, 2.5});
}
BENCHMARK(BM_Traces)->ArgName("percent")->Arg(10)->Arg(30)->Arg(50)->Unit(benchmark::kMillisecond);

std::unique_ptr<BrickedVolume> bricked(GapBox gap) {
  for (std::size_t at = 0; at < gap.state.size(); ++at)
    if (gap.state[at] == NodeState::wanted) gap.samples.value[at] = std::numeric_limits<float>::quiet_NaN();
  return make_bricked_volume(gap.samples.shape, gap.samples.value);
}

void fill_by_distance(benchmark::State& state, GapBox gap) {
  const auto volume = bricked(gap);
  NoProgress progress;
  const auto method = InverseDistanceFill::build(*volume, {2, 1, 2.5}, 1, progress);
  for (auto _ : state) {
    const auto filled = method->fill(gap, progress);
    benchmark::DoNotOptimize(filled.has_value());
  }
  set_rates(state, gap);
}

/// Scattered single nodes in 128^3. Argument: per mille missing.
void BM_InverseDistancePoints(benchmark::State& state) {
  test::Random random(4);
  GapBox gap = layers_box({128, 128, 128});
  const double share = static_cast<double>(state.range(0)) / 1000;
  test::knock_out(gap, [&](int, int, int) { return random.unit() < share; });
  fill_by_distance(state, std::move(gap));
}
BENCHMARK(BM_InverseDistancePoints)->ArgName("per_mille")->Arg(1)->Arg(10)->Arg(100)->Unit(benchmark::kMillisecond);

/// A hole of 20 x 20 traces in 128^3.
void BM_InverseDistanceHole(benchmark::State& state) {
  GapBox gap = layers_box({128, 128, 128});
  test::knock_out(gap, [](int i, int j, int) { return i >= 50 && i < 70 && j >= 50 && j < 70; });
  fill_by_distance(state, std::move(gap));
}
BENCHMARK(BM_InverseDistanceHole)->Unit(benchmark::kMillisecond);

/// The pyramid of 256^3 samples.
void BM_InverseDistanceBuild(benchmark::State& state) {
  const auto volume = bricked(layers_box({256, 256, 256}));
  NoProgress progress;
  for (auto _ : state) benchmark::DoNotOptimize(InverseDistanceFill::build(*volume, {2, 1, 2.5}, 1, progress));
}
BENCHMARK(BM_InverseDistanceBuild)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace geosis
