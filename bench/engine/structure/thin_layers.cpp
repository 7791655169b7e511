// Prints what a structural grid does for a thin layer, as docs/structural-grid.md tells; see bench/README.md.

#include <cstdio>
#include <limits>

#include "engine/pipeline/describe_bodies.h"
#include "engine/pipeline/reconstruct.h"
#include "engine/volume/brick_file.h"
#include "tests/support/thin_layer.h"

namespace geosis {
namespace {

void report(const test::ThinLayer& layer) {
  const auto field = test::samples_of(layer);
  const auto volume = make_bricked_volume(field.shape, field.samples);
  for (const GridChoice choice : {GridChoice::given, GridChoice::structural}) {
    ReconstructOptions options;
    options.range = {test::kThinLayerLevel, std::numeric_limits<float>::infinity()};
    options.grid = choice;
    options.attributes = {.reliability = false, .body = true};
    options.levels = by_ratio({1, 0.25, 0.0625});
    options.threads = 2;
    NoProgress progress;
    StageTimings timings;
    const auto result = reconstruct({*volume, AffineGeometry()}, options, progress, &timings);
    const auto bodies = describe_bodies({*volume, AffineGeometry()}, options, progress);
    if (!result || !bodies) {
      std::printf("%s\n", (result ? bodies.error() : result.error()).message.c_str());
      continue;
    }
    const auto& m0 = result->levels[0];
    const auto fit = test::fit_of(layer, m0.lod.mesh);
    std::printf(
        "dip %.0f thickness %.1f noise %.1f  %-10s  bodies %5zu  surfaces %5lld  normals %5.1f deg  error %.3f  "
        "triangles %lld, %lld, %lld  layers %d\n",
        layer.dip, layer.thickness, layer.noise, choice == GridChoice::given ? "axis" : "structural", bodies->size(),
        static_cast<long long>(m0.topology.components), fit.normal_degrees, fit.error,
        static_cast<long long>(m0.topology.triangles), static_cast<long long>(result->levels[1].topology.triangles),
        static_cast<long long>(result->levels[2].topology.triangles),
        result->grid ? result->grid->layers : field.shape.samples);
  }
}

}  // namespace
}  // namespace geosis

int main() {
  geosis::report({.dip = 1, .thickness = 2});
  geosis::report({.dip = 2, .thickness = 2});
  geosis::report({.dip = 2, .thickness = 3.5});
  geosis::report({.dip = 3, .thickness = 2});
  geosis::report({.dip = 2, .thickness = 2, .noise = 0.1});
}
