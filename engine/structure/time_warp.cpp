#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/structure/inline_planes.h"
#include "engine/structure/plane_ring.h"
#include "engine/structure/scan_dips.h"
#include "engine/structure/smoothing.h"
#include "engine/structure/warped_trace.h"

namespace geosis {
namespace {

constexpr std::int32_t kBatch = 8;          // planes worked on together
constexpr std::int32_t kFinePerSample = 4;  // places of a trace that are compared: half a lag of half a sample
constexpr std::int32_t kMostLag = static_cast<std::int32_t>(2 * DipField::kSteepest);  // in half samples
constexpr std::size_t kLags = 2 * static_cast<std::size_t>(kMostLag) + 1;
constexpr std::size_t kFinePad = 32;        // fine places beyond a trace's ends
constexpr Vec3d kWarpWindow = {1, 1, 1.5};  // of the dips as they are stored, at every second sample
constexpr int kRefinements = 2;

static_assert(kFinePad > kMostLag);

/// Warps each link's two traces to each other as a whole.
class Warper {
 public:
  Warper(const BrickedVolume& measured, const VerticalScan& vertical, int threads, DipField& field)
      : measured_(measured),
        vertical_(vertical),
        threads_(threads),
        field_(field),
        shape_(measured.shape()),
        samples_(static_cast<std::size_t>(shape_.samples)),
        fine_(samples_ * kFinePerSample + 2 * kFinePad),
        traces_(static_cast<std::size_t>(shape_.crosslines) * fine_, kBatch + 8) {}

  Result<void> run(const Progress& progress, const std::function<void(double)>& report) {
    for (std::int32_t first = 0; first < shape_.inlines; first += kBatch) {
      if (progress.cancelled()) return Error{ErrorCode::cancelled, "the search for dips was cancelled"};
      report(static_cast<double>(first) / shape_.inlines);
      const std::int32_t end = std::min(first + kBatch, shape_.inlines);
      if (auto loaded = load_until(std::min(end + 2, shape_.inlines)); !loaded) return loaded;
      parallel_for(static_cast<std::size_t>(shape_.crosslines), threads_, [&](std::size_t j) {
        if (progress.cancelled()) return;
        for (std::int32_t i = first; i < end; ++i) {
          for (const LinkAxis axis : kLinkAxes) warp(i, static_cast<std::int32_t>(j), axis);
        }
      });
    }
    return {};
  }

 private:
  /// Traces at every quarter of a sample.
  Result<void> load_until(std::int32_t end) {
    if (end <= loaded_) return {};
    const auto box = read_planes(measured_, loaded_, end);
    if (!box) return box.error();
    const double scale = vertical_.deviation > 0 ? 1 / vertical_.deviation : 1;
    const auto crosslines = static_cast<std::size_t>(shape_.crosslines);
    parallel_for(static_cast<std::size_t>(end - loaded_), threads_, [&](std::size_t n) {
      std::vector<float> scaled(samples_);
      WarpedTrace trace;
      for (std::size_t j = 0; j < crosslines; ++j) {
        const float* raw = box->value.data() + (n * crosslines + j) * samples_;
        for (std::size_t k = 0; k < samples_; ++k) {
          scaled[k] = static_cast<float>((raw[k] - vertical_.mean) * scale);
        }
        trace.load(scaled.data(), samples_);
        float* to = traces_.plane(loaded_ + static_cast<std::int32_t>(n)) + j * fine_;
        for (std::size_t m = 0; m < fine_; ++m) {
          const float place = (static_cast<float>(m) - static_cast<float>(kFinePad)) / kFinePerSample;
          to[m] = trace.point(0, std::clamp(place, 0.0f, static_cast<float>(samples_ - 1))).value;
        }
      }
    });
    loaded_ = end;
    return {};
  }

  const float* fine_trace(std::int32_t i, std::int32_t j) const {
    return traces_.plane(i) + static_cast<std::size_t>(j) * fine_ + kFinePad;
  }

  void warp(std::int32_t i, std::int32_t j, LinkAxis axis) {
    if (!field_.has_link(i, j, axis)) return;
    thread_local std::vector<float> error, cost;
    thread_local std::vector<std::int8_t> from;
    thread_local std::vector<std::int32_t> lag;
    error.assign(samples_ * kLags, 0.0f);
    for (std::int32_t di = -1; di <= 1; ++di) {
      for (std::int32_t dj = -1; dj <= 1; ++dj) {
        const std::int32_t a = i + di, b = j + dj;
        if (a < 0 || b < 0 || a >= shape_.inlines || b >= shape_.crosslines || !field_.has_link(a, b, axis)) continue;
        add_errors(fine_trace(a, b), axis == LinkAxis::inline_ ? fine_trace(a + 1, b) : fine_trace(a, b + 1), error);
      }
    }
    std::int16_t* dip = field_.dips(field_.trace_of(i, j), axis);
    if (std::all_of(error.begin(), error.end(), [](float e) { return e == 0; })) {
      std::fill_n(dip, field_.dips(), DipField::kUnknown);
      return;
    }
    find_path(error, cost, from, lag);
    for (std::int32_t m = 0; m < field_.dips(); ++m) {
      dip[m] = DipField::stored(0.5f * static_cast<float>(lag[static_cast<std::size_t>(m * DipField::kDipSpacing)]));
    }
  }

  /// error (samples, lags): squared differences of the one trace half a lag above, the other half a lag below.
  void add_errors(const float* here, const float* next, std::vector<float>& error) const {
    for (std::size_t k = 0; k < samples_; ++k) {
      const float* a = here + k * kFinePerSample + kMostLag;
      const float* b = next + k * kFinePerSample - kMostLag;
      float* to = error.data() + k * kLags;
      for (std::size_t l = 0; l < kLags; ++l) {
        const float difference = b[l] - a[-static_cast<std::ptrdiff_t>(l)];
        const float squared = difference * difference;
        to[l] += squared == squared ? squared : 0.0f;
      }
    }
  }

  /// The lags of least error in all that change by at most one in two samples.
  void find_path(const std::vector<float>& error, std::vector<float>& cost, std::vector<std::int8_t>& from,
                 std::vector<std::int32_t>& lag) const {
    cost.assign(samples_ * kLags, 0.0f);
    from.assign(samples_ * kLags, 0);
    std::copy_n(error.begin(), kLags, cost.begin());
    for (std::size_t k = 1; k < samples_; ++k) {
      const float *above = &cost[(k - 1) * kLags], *here_error = &error[k * kLags];
      float* here = &cost[k * kLags];
      if (k == 1) {
        for (std::size_t l = 0; l < kLags; ++l) here[l] = above[l] + here_error[l];
        continue;
      }
      const float *two_above = &cost[(k - 2) * kLags], *error_above = &error[(k - 1) * kLags];
      for (std::size_t l = 0; l < kLags; ++l) {
        constexpr float kNever = std::numeric_limits<float>::max();
        const float stay = above[l];
        const float up = l > 0 ? two_above[l - 1] + error_above[l - 1] : kNever;
        const float down = l + 1 < kLags ? two_above[l + 1] + error_above[l + 1] : kNever;
        const float side = std::min(up, down);
        here[l] = std::min(stay, side) + here_error[l];
        from[k * kLags + l] = static_cast<std::int8_t>(stay <= side ? 0 : up <= down ? -1 : 1);
      }
    }
    trace_back(cost, from, lag);
  }

  void trace_back(const std::vector<float>& cost, const std::vector<std::int8_t>& from,
                  std::vector<std::int32_t>& lag) const {
    lag.resize(samples_);
    const auto last = cost.end() - static_cast<std::ptrdiff_t>(kLags);
    auto l = static_cast<std::size_t>(std::min_element(last, cost.end()) - last);
    for (std::size_t k = samples_; k-- > 0;) {
      lag[k] = static_cast<std::int32_t>(l) - kMostLag;
      const std::int8_t step = from[k * kLags + l];
      if (step == 0) continue;
      l = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(l) + step);
      lag[--k] = static_cast<std::int32_t>(l) - kMostLag;  // it came from two samples above
    }
  }

  const BrickedVolume& measured_;
  const VerticalScan& vertical_;
  const int threads_;
  DipField& field_;
  const GridShape shape_;
  const std::size_t samples_, fine_;
  PlaneRing<float> traces_;
  std::int32_t loaded_ = 0;
};

/// The dips of one axis, smoothed; no unknown ones.
void smooth_dips(DipField& field, LinkAxis axis, int threads) {
  const GridShape shape = {field.shape().inlines, field.shape().crosslines, field.dips()};
  const auto count = static_cast<std::size_t>(shape.count());
  std::int16_t* dip = field.dips(0, axis);
  std::vector<float> sum(dip, dip + count), weight(count, 1.0f);
  smooth(sum, shape, kWarpWindow, threads);
  smooth(weight, shape, kWarpWindow, threads);
  for (std::size_t n = 0; n < count; ++n) dip[n] = static_cast<std::int16_t>(std::lround(sum[n] / weight[n]));
}

}  // namespace

Result<void> warp_dips(const BrickedVolume& measured, const VerticalScan& scan, int threads, const Progress& progress,
                       const std::function<void(double)>& report, DipField& field) {
  if (auto done = Warper(measured, scan, threads, field).run(progress, report); !done) return done;
  spread_dips(field, threads);
  for (const LinkAxis axis : kLinkAxes) {
    if (progress.cancelled()) return Error{ErrorCode::cancelled, "the search for dips was cancelled"};
    smooth_dips(field, axis, threads);
  }
  for (int n = 0; n < kRefinements; ++n) {
    if (auto done = refine_dips(
            measured, scan, threads, progress, [](double) {}, field);
        !done)
      return done;
  }
  return {};
}

}  // namespace geosis
