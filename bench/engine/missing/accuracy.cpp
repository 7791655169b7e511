// How well gaps are filled: known samples of a survey are removed, filled and compared.
//
//     fill_accuracy SURVEY.sgy [linear|polyharmonic|inverse_distance] [on|off|auto] [seed]
//
// rmse   root mean square error of the removed samples / standard deviation of the whole field: 1 = as bad as its mean
// wrong  removed samples put on the wrong side of a range, per sample truly inside it. The range begins one standard
//        deviation above the mean, or is [0.35, 1.42] with --petrel.
// trust  mean R of the removed samples, against 1 - rmse^2

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "engine/missing/fill.h"
#include "engine/volume/brick_file.h"
#include "engine/volume/formats/import.h"
#include "engine/volume/sample_box.h"
#include "tests/support/random.h"

namespace geosis {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

struct Field {
  GridShape shape;
  std::vector<float> samples;

  float& at(std::int32_t i, std::int32_t j, std::int32_t k) {
    return samples[(static_cast<std::size_t>(i) * shape.crosslines + j) * shape.samples + k];
  }
  void remove_trace(std::int32_t i, std::int32_t j) {
    for (std::int32_t k = 0; k < shape.samples; ++k) at(i, j, k) = kMissing;
  }
  void remove_traces(std::int32_t i, std::int32_t j, std::int32_t inlines, std::int32_t crosslines) {
    for (std::int32_t a = i; a < i + inlines; ++a)
      for (std::int32_t b = j; b < j + crosslines; ++b) remove_trace(a, b);
  }
};

void remove_points(Field& field, test::Random& random, double share) {
  for (float& value : field.samples)
    if (random.unit() < share) value = kMissing;
}

void remove_some_traces(Field& field, test::Random& random, double share) {
  for (std::int32_t i = 0; i < field.shape.inlines; ++i)
    for (std::int32_t j = 0; j < field.shape.crosslines; ++j)
      if (random.unit() < share) field.remove_trace(i, j);
}

void remove_box(Field& field, std::int32_t side) {
  const GridShape& shape = field.shape;
  const std::int32_t i = (shape.inlines - side) / 2, j = (shape.crosslines - side) / 2, k = (shape.samples - side) / 2;
  for (std::int32_t a = i; a < i + side; ++a)
    for (std::int32_t b = j; b < j + side; ++b)
      for (std::int32_t c = k; c < k + side; ++c) field.at(a, b, c) = kMissing;
}

struct Case {
  const char* name;
  std::function<void(Field&, test::Random&)> remove;
};

/// As in the middle of the survey; hole and box are smaller in a small one.
std::vector<Case> cases(GridShape shape) {
  const std::int32_t narrow = std::min(shape.inlines, shape.crosslines);
  const std::int32_t hole = narrow >= 60 ? 20 : 8, box = narrow >= 60 ? 40 : 10;
  return {{"points 1 %", [](Field& f, test::Random& r) { remove_points(f, r, 0.01); }},
          {"points 5 %", [](Field& f, test::Random& r) { remove_points(f, r, 0.05); }},
          {"points 20 %", [](Field& f, test::Random& r) { remove_points(f, r, 0.2); }},
          {"traces 10 %", [](Field& f, test::Random& r) { remove_some_traces(f, r, 0.1); }},
          {"traces 30 %", [](Field& f, test::Random& r) { remove_some_traces(f, r, 0.3); }},
          {"5 inlines",
           [](Field& f, test::Random&) { f.remove_traces(f.shape.inlines / 2 - 2, 0, 5, f.shape.crosslines); }},
          {"hole",
           [hole](Field& f, test::Random&) {
             f.remove_traces((f.shape.inlines - hole) / 2, (f.shape.crosslines - hole) / 2, hole, hole);
           }},
          {"box", [box](Field& f, test::Random&) { remove_box(f, box); }}};
}

struct Range {
  double low, high;
  bool holds(double value) const { return value >= low && value <= high; }
};

struct Moments {
  double mean = 0, deviation = 0;
};
Moments moments_of(const std::vector<float>& samples) {
  double sum = 0, squares = 0, count = 0;
  for (const float value : samples)
    if (value == value) sum += value, squares += double{value} * value, ++count;
  const double mean = sum / count;
  return {mean, std::sqrt(squares / count - mean * mean)};
}

/// R of each node that was filled.
std::vector<double> reliabilities(const FilledVolume& filled) {
  const GridShape shape = filled.shape();
  std::vector<double> trust(static_cast<std::size_t>(shape.count()), 1);
  for (std::size_t number = 0; number < filled.brick_count(); ++number) {
    const auto brick = filled.brick(number);
    if (!brick) std::exit(1);
    for (const FilledSample& record : filled.filled(number)) {
      const auto place = static_cast<std::int32_t>(record.place), row = place / brick->extent.samples;
      const std::int32_t i = brick->first.i + row / brick->extent.crosslines;
      const std::int32_t j = brick->first.j + row % brick->extent.crosslines;
      const std::int32_t k = brick->first.k + place % brick->extent.samples;
      trust[(static_cast<std::size_t>(i) * shape.crosslines + j) * shape.samples + k] = record.reliability / 254.0;
    }
  }
  return trust;
}

void report(const Case& gap, const Field& truth, Range range, const FillOptions& options, std::uint64_t seed) {
  Field field = truth;
  test::Random random(seed);
  gap.remove(field, random);
  const auto volume = make_bricked_volume(field.shape, field.samples);
  NoProgress unwatched;
  const auto filled = fill_missing(*volume, options, std::nullopt, 2, unwatched);
  if (!filled) {
    std::printf("%-12s %s\n", gap.name, filled.error().message.c_str());
    return;
  }
  const auto box = read_box(**filled, whole(field.shape));
  const std::vector<double> trust = reliabilities(**filled);
  double squares = 0, count = 0, wrong = 0, inside = 0, left = 0, trusted = 0;
  for (std::size_t n = 0; n < truth.samples.size(); ++n) {
    const double value = truth.samples[n], guess = box->value[n];
    if (field.samples[n] == field.samples[n] || value != value) continue;
    left += guess != guess;
    if (guess != guess) continue;
    ++count;
    trusted += trust[n];
    squares += (guess - value) * (guess - value);
    inside += range.holds(value);
    wrong += range.holds(value) != range.holds(guess);
  }
  const double rmse = std::sqrt(squares / count) / moments_of(truth.samples).deviation;
  std::printf("%-12s removed %8.0f  left %6.0f  rmse %.3f  wrong %.2f  trust %.2f (1 - rmse^2: %.2f)\n", gap.name,
              count + left, left, rmse, wrong / inside, trusted / count, 1 - rmse * rmse);
}

Field read_survey(const char* path, const char* crop) {
  NoProgress unwatched;
  const auto source = open_file(path);
  if (!source) {
    std::fprintf(stderr, "%s\n", source.error().message.c_str());
    std::exit(1);
  }
  const auto imported = import_volume(**source, {}, std::nullopt, unwatched);
  if (!imported) {
    std::fprintf(stderr, "%s\n", imported.error().message.c_str());
    std::exit(1);
  }
  const GridShape shape = imported->samples->shape();
  GridBox box = whole(shape);
  if (crop != nullptr && std::sscanf(crop, "%d:%d,%d:%d,%d:%d", &box.first.i, &box.last.i, &box.first.j, &box.last.j,
                                     &box.first.k, &box.last.k) != 6) {
    std::fprintf(stderr, "%s: expected I0:I1,J0:J1,K0:K1\n", crop);
    std::exit(1);
  }
  for (int axis = 0; axis < 3; ++axis) {
    box.first[axis] = std::clamp(box.first[axis], 0, shape[axis] - 1);
    box.last[axis] = std::clamp(box.last[axis], box.first[axis], shape[axis] - 1);
  }
  auto samples = read_box(*imported->samples, box);
  return {samples->shape, std::move(samples->value)};
}

int run(int count, char** arguments) {
  const std::string method = count > 2 ? arguments[2] : "linear", steer = count > 3 ? arguments[3] : "auto";
  const std::uint64_t seed = 1;
  FillOptions options{.method = method == "linear" ? FillMethod::linear : FillMethod::rbf};
  if (method == "inverse_distance") options.kernel = RbfKernel::inverse_distance;
  options.steer = steer == "on" ? FillSteering::on : steer == "off" ? FillSteering::off : FillSteering::automatic;
  const Field truth = read_survey(arguments[1], count > 5 ? arguments[5] : nullptr);
  const Moments moments = moments_of(truth.samples);
  const Range range{count > 4 ? std::strtod(arguments[4], nullptr) : moments.mean + moments.deviation, 1e30};
  std::printf("%s: %d x %d x %d, mean %g, deviation %g; %s, steer %s; seed %llu\n", arguments[1], truth.shape.inlines,
              truth.shape.crosslines, truth.shape.samples, moments.mean, moments.deviation, method.c_str(),
              steer.c_str(), static_cast<unsigned long long>(seed));
  for (const Case& gap : cases(truth.shape)) report(gap, truth, range, options, seed);
  return 0;
}

}  // namespace
}  // namespace geosis

int main(int count, char** arguments) {
  if (count >= 2) return geosis::run(count, arguments);
  std::fprintf(stderr,
               "usage: fill_accuracy SURVEY.sgy [linear|polyharmonic|inverse_distance] [on|off|auto] [LOW]\n"
               "                     [I0:I1,J0:J1,K0:K1]\n");
  return 2;
}
