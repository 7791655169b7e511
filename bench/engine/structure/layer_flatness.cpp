// Prints how alike traces are that lie some traces apart, sample by sample and layer by layer, on any survey.

#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "engine/structure/structural_grid.h"
#include "engine/volume/formats/byte_source.h"
#include "engine/volume/formats/import.h"
#include "engine/volume/sample_box.h"

namespace geosis {
namespace {

/// Mean over layers of the correlation of a layer's samples with those `apart` traces on.
struct Sums {
  double x = 0, y = 0, xx = 0, yy = 0, xy = 0, n = 0;
  void add(double a, double b) { x += a, y += b, xx += a * a, yy += b * b, xy += a * b, ++n; }
  double correlation() const { return (xy - x * y / n) / std::sqrt((xx - x * x / n) * (yy - y * y / n)); }
};

/// The sample at a depth that may lie between two.
double sample_at(const SampleBox& box, std::int32_t i, std::int32_t j, float depth) {
  const auto k = static_cast<std::int32_t>(depth);
  const double t = depth - static_cast<float>(k);
  return (1 - t) * box.value[box.at(i, j, k)] + t * box.value[box.at(i, j, k + 1)];
}

/// Correlation, over layers within the box, of samples and those `apart` traces on.
double correlation(const SampleBox& box, const LayerDepths& depths, int apart, bool along_inlines) {
  Sums sums;
  const std::int32_t di = along_inlines ? apart : 0, dj = along_inlines ? 0 : apart;
  const auto bottom = static_cast<float>(box.shape.samples - 1);
  const auto is_inside = [&](float depth) { return depth >= 0 && depth < bottom; };
  for (std::int32_t i = 0; i + di < box.shape.inlines; ++i) {
    for (std::int32_t j = 0; j + dj < box.shape.crosslines; ++j) {
      const float* here = depths.trace(static_cast<std::size_t>(i) * box.shape.crosslines + j);
      const float* there = depths.trace(static_cast<std::size_t>(i + di) * box.shape.crosslines + j + dj);
      for (std::int32_t l = 0; l < depths.layers; ++l) {
        if (l > 0 && here[l] == here[l - 1]) continue;  // the same sample again
        if (!is_inside(here[l]) || !is_inside(there[l])) continue;
        sums.add(sample_at(box, i, j, here[l]), sample_at(box, i + di, j + dj, there[l]));
      }
    }
  }
  return sums.correlation();
}

/// The same on paths of whole samples; without paths, on the axis grid.
double correlation(const SampleBox& box, const LayerPaths* paths, int apart, bool along_inlines) {
  const std::int32_t layers = paths != nullptr ? paths->layers() : box.shape.samples;
  LayerDepths depths{.shape = box.shape, .layers = layers};
  depths.depth.resize(depths.trace_count() * static_cast<std::size_t>(layers));
  std::vector<std::int32_t> path(static_cast<std::size_t>(layers));
  for (std::int32_t i = 0; i < box.shape.inlines; ++i) {
    for (std::int32_t j = 0; j < box.shape.crosslines; ++j) {
      if (paths != nullptr) paths->get(i, j, path);
      float* to = depths.trace(static_cast<std::size_t>(i) * box.shape.crosslines + j);
      for (std::size_t u = 0; u < path.size(); ++u) to[u] = static_cast<float>(paths != nullptr ? path[u] : u);
    }
  }
  return correlation(box, depths, apart, along_inlines);
}

int run(const char* path) {
  NoProgress progress;
  const auto file = open_file(path);
  if (!file) {
    std::printf("%s\n", file.error().message.c_str());
    return 1;
  }
  auto imported = import_volume(**file, {}, std::nullopt, progress);
  if (!imported) {
    std::printf("%s\n", imported.error().message.c_str());
    return 1;
  }
  const BrickedVolume& volume = *imported->samples;
  const auto grid = build_structural_grid({volume}, {.threads = 2}, progress);
  const auto box = read_box(volume, whole(volume.shape()));
  auto measured = measure_dips({volume}, 2, progress);
  if (!grid || !box || !measured) return 1;
  (void)scan_agreements(
      volume, measured->scan, 2, progress, [](double) {}, measured->field);
  const auto layers = lay_layers(measured->field, {.layer_spacing = 1, .threads = 2}, progress);
  if (!layers) return 1;
  std::printf("period %.2f  p95 %.2f %.2f  layers x%.2f  unreliable %.4f  untied %.4f\n", grid->report.dips.period,
              grid->report.dips.dips[0].p95, grid->report.dips.dips[1].p95,
              static_cast<double>(grid->paths.layers()) / volume.shape().samples, grid->report.unreliable_share,
              grid->report.untied_share);
  for (const int apart : {1, 5, 20}) {
    std::printf("%2d apart: axis grid %.3f, %.3f  layers %.3f, %.3f  whole paths %.3f, %.3f\n", apart,
                correlation(*box, nullptr, apart, true), correlation(*box, nullptr, apart, false),
                correlation(*box, *layers, apart, true), correlation(*box, *layers, apart, false),
                correlation(*box, &grid->paths, apart, true), correlation(*box, &grid->paths, apart, false));
  }
  return 0;
}

}  // namespace
}  // namespace geosis

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  return geosis::run(argv[1]);
}
