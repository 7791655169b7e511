// Prints how far the structural grid's layers are from the truth, on surveys of which it is known; see bench/README.md.

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "engine/structure/structural_grid.h"
#include "engine/volume/brick_file.h"
#include "tests/support/layer_errors.h"
#include "tests/support/layered_truth.h"

namespace geosis {
namespace {

void report(const char* name, const test::LayeredOptions& options, std::int32_t spacing) {
  const test::LayeredTruth truth(options);
  const test::ScalarField field = truth.samples();
  const auto volume = make_bricked_volume(field.shape, field.samples);
  NoProgress progress;
  const auto start = std::chrono::steady_clock::now();
  const auto grid = build_structural_grid({*volume}, {.layer_spacing = spacing, .threads = 2}, progress);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  auto measured = measure_dips({*volume}, 2, progress);
  if (!measured || !grid) {
    std::printf("%-10s %s\n", name, (!grid ? grid.error() : measured.error()).message.c_str());
    return;
  }
  (void)scan_agreements(
      *volume, measured->scan, 2, progress, [](double) {}, measured->field);
  const auto depths = lay_layers(measured->field, {.layer_spacing = spacing, .threads = 2}, progress);
  const auto axis = test::layer_errors(truth, test::axis_depths(field.shape));
  const auto structural = test::layer_errors(truth, *depths);
  std::printf(
      "%-10s %3d  %7.2f / %.3f  %6.3f / %.3f   dip error %.3f  period %.1f  p95 %.2f %.2f  layers x%.2f  "
      "unreliable %.3f untied %.4f  %.2f s\n",
      name, spacing, axis.rms, axis.neighbours, structural.rms, structural.neighbours,
      test::dip_error(truth, measured->field), measured->report.period, measured->report.dips[0].p95,
      measured->report.dips[1].p95, static_cast<double>(grid->paths.layers()) / field.shape.samples,
      grid->report.unreliable_share, grid->report.untied_share, seconds);
}

}  // namespace
}  // namespace geosis

int main() {
  using geosis::test::Layering;
  const std::pair<const char*, Layering> cases[] = {{"gentle", Layering::gentle},
                                                    {"steep", Layering::steep},
                                                    {"growth", Layering::growth},
                                                    {"faulted", Layering::faulted}};
  std::printf("           spacing  axis grid: rms, neighbours within half a sample; structural grid: the same\n");
  for (const auto& [name, layering] : cases) {
    for (const int spacing : {1, 4, 8, 16}) geosis::report(name, {.layering = layering}, spacing);
  }
  for (const double dip : {1.0, 2.0, 3.0, 4.0, 6.0, 8.0}) {
    geosis::report(("plane " + std::to_string(static_cast<int>(dip))).c_str(),
                   {.shape = {40, 40, 160}, .layering = Layering::plane, .dip = dip}, 0);
  }
}
