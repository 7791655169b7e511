// How well gaps of known content come back: samples of surveys are removed, filled along the dips, and compared.
//
//     steering_accuracy [survey.sgy]
//
// rmse is the error beside the survey's standard deviation (1 = as bad as its mean), over gaps at several places.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <optional>
#include <string>
#include <vector>

#include "engine/missing/plate/steered_plate.h"
#include "engine/volume/formats/import.h"
#include "engine/volume/synthetic_survey.h"
#include "tests/support/random.h"

namespace geosis {
namespace {

constexpr std::uint64_t kSeed = 1;
constexpr int kPlaces = 3;

struct Survey {
  std::string name;
  SampleBox samples;
  float low, high;  // the range whose body's samples must not change sides
};

double deviation(const std::vector<float>& values) {
  double sum = 0, squares = 0;
  for (const float v : values) sum += v;
  const double mean = sum / static_cast<double>(values.size());
  for (const float v : values) squares += (v - mean) * (v - mean);
  return std::sqrt(squares / static_cast<double>(values.size()));
}

/// Root mean square of the differences along each axis, beside the deviation.
Vec3d measure_steps(const SampleBox& box) {
  Vec3d steps;
  const double whole = deviation(box.value);
  const std::size_t strides[3] = {static_cast<std::size_t>(box.shape.crosslines) * box.shape.samples,
                                  static_cast<std::size_t>(box.shape.samples), 1};
  for (int axis = 0; axis < 3; ++axis) {
    double sum = 0;
    std::int64_t count = 0;
    for (std::int32_t i = 0; i + (axis == 0) < box.shape.inlines; ++i) {
      for (std::int32_t j = 0; j + (axis == 1) < box.shape.crosslines; ++j) {
        for (std::int32_t k = 0; k + (axis == 2) < box.shape.samples; ++k, ++count) {
          const double step = box.value[box.at(i, j, k) + strides[axis]] - box.value[box.at(i, j, k)];
          sum += step * step;
        }
      }
    }
    steps[axis] = std::sqrt(sum / static_cast<double>(count) / (2 * whole * whole));
  }
  const double largest = std::max({steps.x, steps.y, steps.z});
  for (int axis = 0; axis < 3; ++axis) steps[axis] = std::max(steps[axis], largest / 20);
  return steps;
}

/// The axis barycentre of the nearest known samples: what the steered fill starts from and is compared with.
float barycentre(const GapBox& gap, GridIndex node, const Vec3d& steps) {
  double pairs = 0, pair_weight = 0, lonely = 0, lonely_weight = 0;
  for (int axis = 0; axis < 3; ++axis) {
    double value[2] = {}, near[2] = {};
    for (int side = 0; side < 2; ++side) {
      GridIndex at = node;
      for (int distance = 1;; ++distance) {
        at[axis] += 2 * side - 1;
        if (at[axis] < 0 || at[axis] >= gap.samples.shape[axis]) break;
        const std::size_t n = gap.samples.at(at.i, at.j, at.k);
        if (gap.state[n] != NodeState::known) continue;
        value[side] = gap.samples.value[n];
        near[side] = 1 / (steps[axis] * distance);
        break;
      }
    }
    const double sum = near[0] * value[0] + near[1] * value[1], weight = near[0] + near[1];
    if (near[0] > 0 && near[1] > 0) {
      pairs += weight * sum;
      pair_weight += weight * weight;
    } else {
      lonely += sum * weight;
      lonely_weight += weight * weight;
    }
  }
  const double value = pair_weight > 0 ? pairs / pair_weight : lonely_weight > 0 ? lonely / lonely_weight : 0;
  return static_cast<float>(value);
}

/// The survey around a gap, with its samples taken away.
GapBox knock_out(const SampleBox& survey, const GridBox& hole, const Vec3d& steps) {
  const std::int32_t margin[3] = {kSteeringMarginTraces, kSteeringMarginTraces, kSteeringMarginSamples};
  GapBox gap;
  GridIndex last;
  for (int axis = 0; axis < 3; ++axis) {
    gap.samples.first[axis] = std::max(hole.first[axis] - margin[axis], 0);
    last[axis] = std::min(hole.last[axis] + margin[axis], survey.shape[axis] - 1);
  }
  const GridIndex first = gap.samples.first;
  gap.samples.shape = {last.i - first.i + 1, last.j - first.j + 1, last.k - first.k + 1};
  std::vector<GridIndex> wanted;
  for (std::int32_t i = first.i; i <= last.i; ++i) {
    for (std::int32_t j = first.j; j <= last.j; ++j) {
      for (std::int32_t k = first.k; k <= last.k; ++k) {
        const GridIndex node = {i, j, k};
        bool is_inside = true;
        for (int axis = 0; axis < 3; ++axis) {
          is_inside &= node[axis] >= hole.first[axis] && node[axis] <= hole.last[axis];
        }
        gap.samples.value.push_back(survey.value[survey.at(i, j, k)]);
        gap.state.push_back(is_inside ? NodeState::wanted : NodeState::known);
        if (is_inside) wanted.push_back({i - first.i, j - first.j, k - first.k});
      }
    }
  }
  for (const GridIndex& node : wanted) {
    gap.samples.value[gap.samples.at(node.i, node.j, node.k)] = barycentre(gap, node, steps);
  }
  return gap;
}

struct Score {
  double squares = 0, seconds = 0;
  std::int64_t nodes = 0, inside = 0, wrong = 0;

  void add(const GapBox& gap, const Survey& survey) {
    std::size_t n = 0;
    const GridIndex first = gap.samples.first;
    for (std::int32_t i = 0; i < gap.samples.shape.inlines; ++i) {
      for (std::int32_t j = 0; j < gap.samples.shape.crosslines; ++j) {
        for (std::int32_t k = 0; k < gap.samples.shape.samples; ++k, ++n) {
          if (gap.state[n] != NodeState::wanted) continue;
          const float truth = survey.samples.value[survey.samples.at(first.i + i, first.j + j, first.k + k)];
          const float found = gap.samples.value[n];
          squares += (double{found} - truth) * (double{found} - truth);
          const auto in = [&](float v) { return v >= survey.low && v <= survey.high; };
          inside += in(truth);
          wrong += in(truth) != in(found);
          ++nodes;
        }
      }
    }
  }
  double rmse(double whole) const { return std::sqrt(squares / static_cast<double>(nodes)) / whole; }
  double wrong_share() const {
    return static_cast<double>(wrong) / static_cast<double>(std::max<std::int64_t>(inside, 1));
  }
};

void measure(const Survey& survey, const char* what, GridShape hole, test::Random& random) {
  const Vec3d steps = measure_steps(survey.samples);
  const double whole = deviation(survey.samples.value);
  const auto [low, high] = std::minmax_element(survey.samples.value.begin(), survey.samples.value.end());
  Score linear, steered;
  for (int place = 0; place < kPlaces; ++place) {
    GridBox box;
    for (int axis = 0; axis < 3; ++axis) {
      const std::int32_t length = std::min(hole[axis], survey.samples.shape[axis]);
      const std::int32_t room = survey.samples.shape[axis] - length;
      // Away from the survey's border, where there is the room.
      const std::int32_t border = std::min(room / 2, 8);
      box.first[axis] = random.integer(border, room - border);
      box.last[axis] = box.first[axis] + length - 1;
    }
    GapBox gap = knock_out(survey.samples, box, steps);
    linear.add(gap, survey);
    NoProgress progress;
    const std::clock_t begin = std::clock();  // of the processor: one thread works
    fill_steered_plate(gap, steps, {.low = *low, .high = *high}, progress);
    steered.seconds += static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    steered.add(gap, survey);
  }
  std::printf("%-12s %-10s linear %.3f / %.2f   along dips %.3f / %.2f   %.1f us a node (%lld)\n", survey.name.c_str(),
              what, linear.rmse(whole), linear.wrong_share(), steered.rmse(whole), steered.wrong_share(),
              1e6 * steered.seconds / static_cast<double>(steered.nodes), static_cast<long long>(steered.nodes));
}

Survey synthetic(const char* name, SurveyKind kind, float low, float high) {
  Survey survey{name, {{}, {100, 100, 140}, {}}, low, high};
  const SyntheticSurvey made({.shape = survey.samples.shape, .kind = kind, .seed = kSeed});
  std::vector<float> trace(140);
  for (std::int32_t i = 0; i < 100; ++i) {
    for (std::int32_t j = 0; j < 100; ++j) {
      made.fill_trace(i, j, trace);
      survey.samples.value.insert(survey.samples.value.end(), trace.begin(), trace.end());
    }
  }
  return survey;
}

/// Parallel reflectors of random strength under a dip of that many samples per trace, with folds and 12 % noise.
Survey dipping(const char* name, double dip) {
  Survey survey{name, {{}, {100, 100, 140}, {}}, 0.5f, 9.0f};
  test::Random random(kSeed);
  std::vector<double> layer(400);
  for (double& amplitude : layer) amplitude = random.unit() * 2 - 1;
  const auto reflector = [&](double depth) {
    const double place = depth / 5 + 150;
    const auto above = static_cast<std::size_t>(std::clamp(place, 0.0, 397.0));
    const double t = place - static_cast<double>(above), s = t * t * (3 - 2 * t);
    return (1 - s) * layer[above] + s * layer[above + 1];
  };
  for (std::int32_t i = 0; i < 100; ++i) {
    for (std::int32_t j = 0; j < 100; ++j) {
      const double fold = dip * (i - 50) + 0.4 * dip * (j - 50) + 4 * std::sin(i / 14.0) * std::sin(j / 17.0 + 1);
      for (std::int32_t k = 0; k < 140; ++k) {
        const double noise = 0.12 * (random.unit() + random.unit() - 1);
        survey.samples.value.push_back(static_cast<float>(reflector(k - fold) + noise));
      }
    }
  }
  return survey;
}

std::optional<Survey> from_file(const char* path) {
  const auto file = open_file(path);
  if (!file) return std::nullopt;
  NoProgress progress;
  const auto imported = import_volume(**file, {}, std::nullopt, progress);
  if (!imported) return std::nullopt;
  const GridShape shape = imported->samples->shape();
  const GridBox crop = {
      {0, std::min(40, shape.crosslines / 4), std::min(60, shape.samples / 4)},
      {std::min(75, shape.inlines - 1), std::min(139, shape.crosslines - 1), std::min(199, shape.samples - 1)}};
  auto box = read_box(*imported->samples, crop);
  if (!box) return std::nullopt;
  return Survey{"file", std::move(*box), 0.35f, 1.42f};
}

void measure_all(const Survey& survey) {
  test::Random random(kSeed);
  measure(survey, "5 inlines", {5, 1000, 1000}, random);
  measure(survey, "hole 20x20", {20, 20, 1000}, random);
  measure(survey, "box 40^3", {40, 40, 40}, random);
}

}  // namespace
}  // namespace geosis

int main(int argc, char** argv) {
  using namespace geosis;
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  std::printf("seed %llu; rmse / samples on the wrong side of the range\n", static_cast<unsigned long long>(kSeed));
  if (argc > 1) {
    const auto survey = from_file(argv[1]);
    if (!survey) {
      std::fprintf(stderr, "%s: cannot be read\n", argv[1]);
      return 1;
    }
    measure_all(*survey);
  }
  measure_all(synthetic("reflectors", SurveyKind::reflectors, 0.2f, 9));
  measure_all(synthetic("channel", SurveyKind::channel, 0.55f, 9));
  measure_all(dipping("dip 0.5", 0.5));
  measure_all(dipping("dip 1.5", 1.5));
  return 0;
}
