#include "engine/structure/whole_paths.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "engine/base/parallel.h"

namespace geosis {
namespace {

constexpr double kUsualShare = 0.95;         // of traces that layers keep up with
constexpr std::size_t kLayersTogether = 16;  // what one look at a trace's memory brings along

/// A place between two layers: fraction of the way from `below` to the next.
struct Place {
  std::int32_t below = 0;
  float fraction = 0;
};

/// How far all traces but the fastest few go on within the box between each layer and the next.
std::vector<float> usual_rise(const LayerDepths& depths, int threads) {
  const auto layers = static_cast<std::size_t>(depths.layers);
  const auto bottom = static_cast<float>(depths.shape.samples - 1);
  std::vector<float> usual(layers - 1, 0.0f);
  parallel_for((layers - 1 + kLayersTogether - 1) / kLayersTogether, threads, [&](std::size_t block) {
    const std::size_t first = block * kLayersTogether, end = std::min(first + kLayersTogether, layers - 1);
    std::vector<std::vector<float>> rises(end - first);
    for (std::size_t t = 0; t < depths.trace_count(); ++t) {
      const float* z = depths.trace(t);
      for (std::size_t l = first; l < end; ++l) {
        if (z[l + 1] > 0 && z[l] < bottom) rises[l - first].push_back(z[l + 1] - z[l]);
      }
    }
    for (std::size_t l = first; l < end; ++l) {
      auto& rise = rises[l - first];
      if (rise.empty()) continue;
      const auto rank = static_cast<std::ptrdiff_t>(kUsualShare * static_cast<double>(rise.size() - 1));
      std::nth_element(rise.begin(), rise.begin() + rank, rise.end());
      usual[l] = rise[static_cast<std::size_t>(rank)];
    }
  });
  return usual;
}

/// Places from the first layer to the last between which no trace goes on by more than one sample.
std::vector<Place> choose_places(const std::vector<float>& usual) {
  std::vector<Place> places;
  double passed = 0;  // of the cumulative rise, at the layer
  double next = 0;    // where the next place is
  for (std::size_t l = 0; l < usual.size(); ++l) {
    const double rise = usual[l];
    for (; rise > 0 && next < passed + rise; ++next) {
      places.push_back({static_cast<std::int32_t>(l), static_cast<float>((next - passed) / rise)});
    }
    passed += rise;
  }
  places.push_back({static_cast<std::int32_t>(usual.size()) - 1, 1.0f});
  return places;
}

/// The trace's samples at the places, going on by 0 or 1.
void round_path(const float* depth, std::span<const Place> places, std::int32_t samples, std::int32_t* path) {
  const auto bottom = static_cast<float>(samples - 1);
  for (std::size_t n = 0; n < places.size(); ++n) {
    const float below = depth[places[n].below], above = depth[places[n].below + 1];
    const float z = std::clamp(below + places[n].fraction * (above - below), 0.0f, bottom);
    const auto sample = static_cast<std::int32_t>(std::lround(z));
    path[n] = n == 0 ? sample : std::clamp(sample, path[n - 1], path[n - 1] + 1);
  }
}

/// A layer parallel to another, some samples above (negative) or below it.
std::int32_t beside(std::int32_t sample, std::int64_t away, std::int32_t samples) {
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(sample + away, 0, samples - 1));
}

}  // namespace

Result<LayerPaths> whole_paths(const LayerDepths& depths, std::int32_t most_layers, int threads) {
  const GridShape shape = depths.shape;
  const std::size_t traces = depths.trace_count();
  const auto crosslines = static_cast<std::size_t>(shape.crosslines);
  const auto planes = static_cast<std::size_t>(shape.inlines);
  const std::vector<Place> places = choose_places(usual_rise(depths, threads));
  std::vector<std::int32_t> first(traces), last(traces);
  parallel_for(planes, threads, [&](std::size_t i) {
    std::vector<std::int32_t> path(places.size());
    for (std::size_t t = i * crosslines; t < (i + 1) * crosslines; ++t) {
      round_path(depths.trace(t), places, shape.samples, path.data());
      first[t] = path.front();
      last[t] = path.back();
    }
  });
  const std::int64_t head = *std::max_element(first.begin(), first.end());
  const std::int64_t tail = shape.samples - 1 - *std::min_element(last.begin(), last.end());
  const std::int64_t layers = head + static_cast<std::int64_t>(places.size()) + tail;
  if (layers > most_layers) {
    return Error{ErrorCode::limit_exceeded, "the structural grid needs " + std::to_string(layers) + " layers for " +
                                                std::to_string(shape.samples) + " samples; at most " +
                                                std::to_string(most_layers)};
  }
  LayerPaths paths(shape, static_cast<std::int32_t>(layers));
  parallel_for(planes, threads, [&](std::size_t i) {
    std::vector<std::int32_t> path(static_cast<std::size_t>(layers));
    for (std::size_t t = i * crosslines; t < (i + 1) * crosslines; ++t) {
      for (std::int64_t n = 0; n < head; ++n)
        path[static_cast<std::size_t>(n)] = beside(first[t], n - head, shape.samples);
      round_path(depths.trace(t), places, shape.samples, path.data() + head);
      for (std::int64_t n = 1; n <= tail; ++n) {
        path[static_cast<std::size_t>(layers - 1 - tail + n)] = beside(last[t], n, shape.samples);
      }
      paths.set(static_cast<std::int32_t>(i), static_cast<std::int32_t>(t % crosslines), path);
    }
  });
  return paths;
}

}  // namespace geosis
