// Extraction, and the whole way to encoded levels, on synthetic surveys of 256 x 256 x 256 samples: the channel alone
// (a compact body: most bricks are skipped) and a range that every reflector crosses (a busy volume).

#include <limits>
#include <span>
#include <vector>

#include <benchmark/benchmark.h>

#include "engine/isosurface/extract.h"
#include "engine/pipeline/reconstruct.h"
#include "engine/volume/brick_file.h"
#include "engine/volume/synthetic_survey.h"

namespace geosis {
namespace {

constexpr GridShape kShape = {256, 256, 256};
constexpr IsoRange kRanges[] = {{0.55f, std::numeric_limits<float>::infinity()}, {0.1f, 0.3f}};

const BrickedVolume& survey() {
  static const auto volume = [] {
    const SyntheticSurvey made({.shape = kShape});
    std::vector<float> samples(static_cast<std::size_t>(kShape.count()));
    const auto length = static_cast<std::size_t>(kShape.samples);
    for (int i = 0; i < kShape.inlines; ++i) {
      for (int j = 0; j < kShape.crosslines; ++j) {
        const auto at = static_cast<std::size_t>(i * kShape.crosslines + j) * length;
        made.fill_trace(i, j, std::span(samples).subspan(at, length));
      }
    }
    return make_bricked_volume(kShape, samples);
  }();
  return *volume;
}

void count(benchmark::State& state, std::size_t triangles) {
  state.counters["triangles"] = static_cast<double>(triangles);
  state.counters["triangles/s"] =
      benchmark::Counter(static_cast<double>(triangles), benchmark::Counter::kIsIterationInvariantRate);
}

void BM_ExtractBody(benchmark::State& state) {
  const IsoRange range = kRanges[state.range(0)];
  std::size_t triangles = 0;
  NoProgress progress;
  for (auto _ : state) {
    const auto mesh =
        extract_body(survey(), range, {.region = whole(kShape), .threads = static_cast<int>(state.range(1))}, progress);
    triangles = mesh->triangles.size();
  }
  count(state, triangles);
}

void BM_Reconstruct(benchmark::State& state) {
  const ReconstructOptions options{.range = kRanges[state.range(0)], .threads = static_cast<int>(state.range(1))};
  std::size_t triangles = 0;
  NoProgress progress;
  for (auto _ : state) {
    const auto result = reconstruct({survey(), AffineGeometry()}, options, progress);
    triangles = result->levels.front().lod.mesh.triangles.size();
  }
  count(state, triangles);
}

void arguments(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgNames({"busy", "threads"})->ArgsProduct({{0, 1}, {1, 2}})->Unit(benchmark::kMillisecond)->UseRealTime();
}

BENCHMARK(BM_ExtractBody)->Apply(arguments);
BENCHMARK(BM_Reconstruct)->Apply(arguments);

}  // namespace
}  // namespace geosis
