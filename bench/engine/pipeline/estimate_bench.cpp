// One row of the table in docs/estimates.md: what estimate_reconstruction says of a range, and what came of it.
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>
#include <thread>

#include "engine/pipeline/estimate.h"
#include "engine/volume/formats/byte_source.h"
#include "engine/volume/formats/import.h"
#include "server/documents/import_options.h"

namespace {

using namespace geosis;

/// RssAnon + RssShmem of this process.
double anonymous_bytes() {
  std::ifstream status("/proc/self/status");
  double kilobytes = 0;
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("RssAnon:") || line.starts_with("RssShmem:")) kilobytes += std::atof(line.c_str() + 9);
  }
  return kilobytes * 1024;
}

/// The highest anonymous_bytes() in its lifetime above those at its start.
class PeakMemory {
 public:
  double above_start() const { return peak_ - start_; }

 private:
  const double start_ = anonymous_bytes();
  std::atomic<double> peak_ = start_;
  std::jthread watcher_{[this](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      peak_ = std::max(peak_.load(), anonymous_bytes());
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }};
};

ImportOptions import_options(int argc, char** argv) {
  ImportOptions options;
  if (argc < 7) return options;
  options.format = FileFormat::raw;
  GridShape shape;
  std::sscanf(argv[4], "%d,%d,%d", &shape.inlines, &shape.crosslines, &shape.samples);
  options.dims = shape;
  const std::string type = argv[5];
  options.dtype = type == "uint8" ? SampleType::uint8 : type == "int16" ? SampleType::int16 : SampleType::float32;
  options.order = std::string(argv[6]) == "inline" ? RawOrder::inline_fastest : RawOrder::sample_fastest;
  return options;
}

double processor_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

void print(const char* what, double estimated, double measured) {
  std::printf(" %s %.4g / %.4g = %.2f |", what, estimated, measured, estimated / measured);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return 2;
  NoProgress unwatched;
  const auto file = open_file(argv[1]);
  if (!file) return std::puts(file.error().message.c_str()), 1;
  const auto volume = import_volume(**file, import_options(argc, argv), std::nullopt, unwatched, nullptr);
  if (!volume) return std::puts(volume.error().message.c_str()), 1;
  ReconstructOptions options;
  options.range = {std::strtof(argv[2], nullptr), std::strtof(argv[3], nullptr)};
  options.threads = 2;

  using Clock = std::chrono::steady_clock;
  const auto before = Clock::now();
  const ReconstructEstimate estimate = estimate_reconstruction(*volume->samples, options);
  const double micros = std::chrono::duration<double, std::micro>(Clock::now() - before).count();

  double bytes = 0, triangles = 0;
  const PeakMemory memory;
  const double start = processor_seconds();
  const auto result =
      reconstruct({.samples = *volume->samples, .geometry = volume->description.geometry}, options, unwatched);
  const double seconds = processor_seconds() - start;
  if (!result) return std::puts(result.error().message.c_str()), 1;
  for (const auto& level : result->levels) {
    for (const auto& part : level.encoded.parts) bytes += static_cast<double>(part.bytes.size());
  }
  if (!result->levels.empty()) triangles = static_cast<double>(result->levels.front().lod.mesh.triangles.size());
  std::printf("| %s [%s, %s] |", argv[1], argv[2], argv[3]);
  print("triangles", static_cast<double>(estimate.triangles), triangles);
  print("bytes", static_cast<double>(estimate.bytes), bytes);
  print("memory", static_cast<double>(estimate.memory_bytes), memory.above_start());
  print("processor seconds", estimate.processor_seconds, seconds);
  std::printf(" estimated in %.0f us |\n", micros);
}
