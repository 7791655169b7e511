#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <malloc.h>

#include "engine/simplify/build_lods.h"
#include "tests/engine/simplify/field_mesh.h"

#ifdef GEOSIS_HAVE_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif

namespace geosis {
namespace {

/// A gyroid with some noise on it, closed on a cube of `nodes` nodes an axis: many handles, no flat places.
const IndexedMesh& phantom(int nodes) {
  static int made_for = 0;
  static IndexedMesh mesh;
  if (made_for == nodes) return mesh;
  const NodeField smooth = gyroid(20, 0.2);
  const NodeField rough = noise(7);
  const std::array<int, 3> shape{nodes, nodes, nodes};
  mesh = mesh_field(
      shape, closed_on_faces(shape, [&](int i, int j, int k) { return smooth(i, j, k) + 0.1 * rough(i, j, k); }));
  made_for = nodes;
  return mesh;
}

void set_rate(benchmark::State& state, const IndexedMesh& mesh) {
  state.counters["triangles"] = static_cast<double>(mesh.triangles.size());
  state.counters["triangles/s"] =
      benchmark::Counter(static_cast<double>(mesh.triangles.size()), benchmark::Counter::kIsIterationInvariantRate);
}

/// Bytes of the process's memory: anonymous now ("RssAnon"), of files now ("RssFile"), all at most since the last
/// forget_peak ("VmHWM").
double memory(const std::string& entry) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(entry)) return 1024 * std::strtod(line.c_str() + entry.size() + 1, nullptr);
  }
  return 0;
}

void forget_peak() {
  std::ofstream("/proc/self/clear_refs") << "5";
}

/// The chain 1/4, 1/16, 1/64, 1/256; arguments: nodes an axis, threads. Memory includes the copy of M0 that build_lods
/// takes, 18 bytes a triangle.
void BM_BuildLods(benchmark::State& state) {
  const IndexedMesh& mesh = phantom(static_cast<int>(state.range(0)));
  NoProgress progress;
  malloc_trim(0);
  const double before = memory("RssAnon");
  forget_peak();
  for (auto _ : state) {
    auto lods = build_lods(mesh, {.threads = static_cast<int>(state.range(1))}, progress);
    if (!lods) return state.SkipWithError(lods.error().message.c_str());
    benchmark::DoNotOptimize(lods->levels.data());
  }
  state.counters["bytes/triangle"] =
      (memory("VmHWM") - memory("RssFile") - before) / static_cast<double>(mesh.triangles.size());
  set_rate(state, mesh);
}
BENCHMARK(BM_BuildLods)
    ->ArgNames({"nodes", "threads"})
    ->ArgsProduct({{37, 60, 83, 168}, {1, 2}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

/// The same chain by the other strategy and placement; arguments: strategy, placement.
void BM_Variants(benchmark::State& state) {
  const IndexedMesh& mesh = phantom(80);
  NoProgress progress;
  const BuildLodsOptions options{.strategy = static_cast<Strategy>(state.range(0)),
                                 .placement = static_cast<Placement>(state.range(1))};
  for (auto _ : state) {
    auto lods = build_lods(mesh, options, progress);
    if (!lods) return state.SkipWithError(lods.error().message.c_str());
    benchmark::DoNotOptimize(lods->levels.data());
  }
  set_rate(state, mesh);
}
BENCHMARK(BM_Variants)
    ->ArgNames({"multiple_choice", "subset"})
    ->ArgsProduct({{0, 1}, {0, 1}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

#ifdef GEOSIS_HAVE_MESHOPTIMIZER
/// The same chain by the peer, which does not keep the topology; one thread.
void BM_Meshoptimizer(benchmark::State& state) {
  const IndexedMesh& mesh = phantom(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    const auto* first = reinterpret_cast<const unsigned*>(mesh.triangles.data());
    std::vector<unsigned> level(first, first + 3 * mesh.triangles.size());
    for (const std::size_t divisor : {4, 16, 64, 256}) {
      std::vector<unsigned> out(level.size());
      const std::size_t target = mesh.triangles.size() / divisor * 3;
      out.resize(meshopt_simplify(out.data(), level.data(), level.size(), &mesh.positions[0].x, mesh.positions.size(),
                                  sizeof(Vec3f), target, 1e9f, 0, nullptr));
      level = std::move(out);
    }
    benchmark::DoNotOptimize(level.data());
  }
  set_rate(state, mesh);
}
BENCHMARK(BM_Meshoptimizer)
    ->ArgName("nodes")
    ->Args({37})
    ->Args({60})
    ->Args({83})
    ->Args({168})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
#endif

}  // namespace
}  // namespace geosis
