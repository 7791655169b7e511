// Times laying a structural grid on a made-up survey of N x N x N samples, and says how much memory that took.

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "engine/structure/structural_grid.h"
#include "engine/volume/brick_writer.h"
#include "engine/volume/synthetic_survey.h"

namespace geosis {
namespace {

using Clock = std::chrono::steady_clock;

/// Kilobytes of a line of /proc/self/status.
long status_kb(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind(name + ":", 0) == 0) return std::atol(line.c_str() + name.size() + 1);
  }
  return 0;
}

/// Watches memory at every report, and when each phase began.
class Watcher final : public Progress {
 public:
  void report(const char*, double fraction) override {
    most_kb_ = std::max(most_kb_, status_kb("RssAnon"));
    if (fraction >= next_) {
      std::printf("  %3.0f %%  %6.2f s  RssAnon %ld MB\n", 100 * fraction,
                  std::chrono::duration<double>(Clock::now() - start_).count(), status_kb("RssAnon") / 1024);
      next_ = fraction + 0.1;
    }
  }
  bool cancelled() const override { return false; }
  long most_mb() const { return most_kb_ / 1024; }

 private:
  Clock::time_point start_ = Clock::now();
  double next_ = 0;
  long most_kb_ = 0;
};

int run(std::int32_t n, int threads) {
  const GridShape shape = {n, n, n};
  const SyntheticSurvey survey({.shape = shape, .polygon = false, .holes = false});
  auto writer = BrickWriter::create(shape, std::nullopt);
  if (!writer) return 1;
  std::vector<float> trace(static_cast<std::size_t>(n));
  for (std::int32_t i = 0; i < n; ++i) {
    for (std::int32_t j = 0; j < n; ++j) {
      survey.fill_trace(i, j, trace);
      writer->put(i, j, 0, trace);
    }
  }
  NoProgress quiet;
  const auto volume = std::move(*writer).finish(threads, quiet);
  if (!volume) return 1;
  Watcher watcher;
  const auto start = Clock::now();
  const auto grid = build_structural_grid({**volume}, {.threads = threads}, watcher);
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  if (!grid) {
    std::printf("%s\n", grid.error().message.c_str());
    return 1;
  }
  std::printf(
      "{\"samples\": %lld, \"threads\": %d, \"seconds\": %.2f, \"rss_anon_mb\": %ld, \"volume_mb\": %lld, "
      "\"layers\": %d, \"period\": %.2f, \"p95\": [%.3f, %.3f], \"unreliable\": %.4f, \"untied\": %.5f}\n",
      static_cast<long long>(shape.count()), threads, seconds, watcher.most_mb(),
      static_cast<long long>(shape.count() * 4 >> 20), grid->paths.layers(), grid->report.dips.period,
      grid->report.dips.dips[0].p95, grid->report.dips.dips[1].p95, grid->report.unreliable_share,
      grid->report.untied_share);
  return 0;
}

}  // namespace
}  // namespace geosis

int main(int argc, char** argv) {
  return geosis::run(argc > 1 ? std::atoi(argv[1]) : 256, argc > 2 ? std::atoi(argv[2]) : 2);
}
