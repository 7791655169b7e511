// Filling a survey of 512 x 512 x 512 samples whose gaps are scattered points, a cube, dead traces or a big hole. The
// volume lies in an unnamed brick file, so its pages are the file's; memory counts what the process itself holds.

#include <atomic>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <benchmark/benchmark.h>

#include "engine/missing/fill.h"
#include "engine/volume/brick_writer.h"

namespace geosis {
namespace {

enum Gaps : std::int64_t { kNone, kPoints, kCube, kTraces, kHole };
constexpr const char* kNames[] = {"none", "points_1_percent", "cube_100", "traces_30_percent", "hole_300"};
constexpr std::int32_t kNodes = 512;

std::uint64_t mix(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

double share(std::int32_t i, std::int32_t j, std::int32_t k) {
  const std::uint64_t place = (static_cast<std::uint64_t>(i) * kNodes + j) * kNodes + k;
  return static_cast<double>(mix(place * 0x9E3779B97F4A7C15u + 1) >> 11) * 0x1p-53;
}

bool inside(std::int32_t i, std::int32_t j, std::int32_t k, std::int32_t side) {
  const std::int32_t first = (kNodes - side) / 2, last = first + side - 1;
  return i >= first && i <= last && j >= first && j <= last && k >= first && k <= last;
}

bool is_missing(Gaps gaps, std::int32_t i, std::int32_t j, std::int32_t k) {
  switch (gaps) {
    case kNone:
      return false;
    case kPoints:
      return share(i, j, k) < 0.01;
    case kCube:
      return inside(i, j, k, 100);
    case kTraces:
      return share(i, j, 0) < 0.3;
    case kHole:
      return inside(i, j, k, 300);
  }
  return false;
}

/// Bent layers: parabolas of the lateral position, a saw tooth down the trace.
float layered(std::int32_t i, std::int32_t j, std::int32_t k) {
  const float bend =
      0.0004f * static_cast<float>((i - 200) * (i - 200)) - 0.0002f * static_cast<float>((j - 90) * (j - 90));
  const float phase = (static_cast<float>(k) + bend) / 24;
  const float part = phase - static_cast<float>(static_cast<std::int32_t>(phase + 1000) - 1000);
  return 16 * part * (1 - part) * (part - 0.5f);
}

std::unique_ptr<BrickedVolume> make_survey(Gaps gaps) {
  auto writer = BrickWriter::create({kNodes, kNodes, kNodes}, std::nullopt);
  if (!writer) return nullptr;
  std::vector<float> trace(kNodes);
  for (std::int32_t i = 0; i < kNodes; ++i)
    for (std::int32_t j = 0; j < kNodes; ++j) {
      for (std::int32_t k = 0; k < kNodes; ++k)
        trace[static_cast<std::size_t>(k)] =
            is_missing(gaps, i, j, k) ? std::numeric_limits<float>::quiet_NaN() : layered(i, j, k);
      writer->put(i, j, 0, trace);
    }
  NoProgress unwatched;
  auto made = std::move(*writer).finish(2, unwatched);
  return made ? *std::move(made) : nullptr;
}

/// One survey at a time: each is half a gigabyte of file.
const BrickedVolume* survey(Gaps gaps) {
  static std::unique_ptr<BrickedVolume> made;
  static Gaps last = kNone;
  if (!made || last != gaps) {
    made.reset();
    made = make_survey(gaps);
    last = gaps;
  }
  return made.get();
}

/// RssAnon + RssShmem in MiB.
double own_memory() {
  std::ifstream status("/proc/self/status");
  double kib = 0;
  for (std::string word; status >> word;)
    if (double part = 0; (word == "RssAnon:" || word == "RssShmem:") && status >> part) kib += part;
  return kib / 1024;
}

/// The largest own_memory() while it lives, sampled every few milliseconds.
class MemoryPeak {
 public:
  MemoryPeak()
      : watcher_([this](const std::stop_token& stop) {
          while (!stop.stop_requested()) {
            const double now = own_memory();
            if (now > peak_) peak_ = now;
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
          }
        }) {}
  double stop() {
    watcher_.request_stop();
    watcher_.join();
    return peak_;
  }

 private:
  double peak_ = 0;
  std::jthread watcher_;
};

void BM_Fill(benchmark::State& state) {
  const auto gaps = static_cast<Gaps>(state.range(1));
  FillOptions options{.method = state.range(0) == 0 ? FillMethod::linear : FillMethod::rbf};
  if (state.range(0) == 2) options.kernel = RbfKernel::inverse_distance;
  const BrickedVolume* volume = survey(gaps);
  if (volume == nullptr) return state.SkipWithError("no room for the survey");
  NoProgress unwatched;
  MemoryPeak peak;
  std::int64_t filled_nodes = 0;
  for (auto _ : state) {
    const auto filled = fill_missing(*volume, options, std::nullopt, static_cast<int>(state.range(2)), unwatched);
    if (!filled) {
      state.SkipWithError(filled.error().message.c_str());
      break;
    }
    filled_nodes = (*filled)->filled_count();
  }
  state.counters["MiB"] = peak.stop();
  state.counters["filled"] = static_cast<double>(filled_nodes);
  state.SetLabel(kNames[gaps]);
}

BENCHMARK(BM_Fill)
    ->ArgNames({"method", "gaps", "threads"})
    ->ArgsProduct({{0, 1, 2}, {kNone, kPoints, kCube, kTraces, kHole}, {1, 2}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace geosis
