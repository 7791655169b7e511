// Times of other libraries beside ours at equal counts: one level of 1/4, 1/16 or 1/64, one thread.

#include <string>

#include <benchmark/benchmark.h>

#include "bench/engine/simplify/bench_mesh.h"
#include "bench/engine/simplify/peers.h"
#include "engine/simplify/build_lods.h"

namespace geosis {
namespace {

const char* const kSurfaces[] = {"channel:256:2", "channel:512:2", "reflectors:256:2"};

const IndexedMesh& surface(const std::string& name) {
  static std::string made;
  static IndexedMesh mesh;
  if (made == name) return mesh;
  auto result = make_bench_mesh(name);
  mesh = result ? std::move(result->m0) : IndexedMesh{};
  made = name;
  return mesh;
}

void set_rate(benchmark::State& state, const IndexedMesh& mesh, std::size_t triangles) {
  state.counters["triangles"] = static_cast<double>(mesh.triangles.size());
  state.counters["left"] = static_cast<double>(triangles);
  state.counters["triangles/s"] =
      benchmark::Counter(static_cast<double>(mesh.triangles.size()), benchmark::Counter::kIsIterationInvariantRate);
}

std::size_t build_one(const IndexedMesh& mesh, double ratio, benchmark::State& state) {
  NoProgress progress;
  const auto lods = build_lods(mesh, {.levels = by_ratio({ratio})}, progress);
  if (!lods) state.SkipWithError(lods.error().message.c_str());
  return lods ? lods->levels[0].mesh.triangles.size() : 0;
}

void run_ours(benchmark::State& state, const char* name, int divisor) {
  const IndexedMesh& mesh = surface(name);
  std::size_t left = 0;
  for (auto _ : state) left = build_one(mesh, 1.0 / divisor, state);
  set_rate(state, mesh, left);
}

void run_peer(benchmark::State& state, const Peer& peer, const char* name, int divisor) {
  const IndexedMesh& mesh = surface(name);
  const std::size_t asked = build_one(mesh, 1.0 / divisor, state);
  std::size_t left = 0;
  for (auto _ : state) left = peer.simplify(mesh, asked).triangles.size();
  set_rate(state, mesh, left);
}

void register_all() {
  for (const char* name : kSurfaces) {
    for (const int divisor : {4, 16, 64}) {
      const std::string suffix = "/" + std::string(name) + "/" + std::to_string(divisor);
      benchmark::RegisterBenchmark(("BM_Ours" + suffix).c_str(), run_ours, name, divisor)
          ->Unit(benchmark::kMillisecond);
      for (const Peer& peer : peers()) {
        benchmark::RegisterBenchmark(("BM_" + peer.name + suffix).c_str(), [=](benchmark::State& state) {
          run_peer(state, peer, name, divisor);
        })->Unit(benchmark::kMillisecond);
      }
    }
  }
}

}  // namespace
}  // namespace geosis

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  geosis::register_all();
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
