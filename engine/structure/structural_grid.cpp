#include "engine/structure/structural_grid.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>

#include "engine/base/parallel.h"
#include "engine/structure/layer_depths.h"
#include "engine/structure/paint_layers.h"
#include "engine/structure/polish_layers.h"
#include "engine/structure/whole_paths.h"
#include "engine/volume/brick_layout.h"

namespace geosis {
namespace {

const char* const kStage = "structure";
constexpr std::int64_t kFewNodes = 2'000'000;  // up to which solving takes a second anyway
constexpr std::int32_t kWidestSpacing = 16;
constexpr double kSteepShare = 0.25;  // of the period: beyond it the tensor may take the wrong peak
constexpr double kFewSteep = 0.05;    // of the dips, for noise has steep ones too: with more, traces are warped

/// Fractions of the whole for one phase of it.
std::function<void(double)> phase(Progress& progress, double from, double to) {
  return [&progress, from, to](double fraction) { progress.report(kStage, from + (to - from) * fraction); };
}

const BrickedVolume& measured_of(const DipSamples& input) {
  return input.measured != nullptr ? *input.measured : input.samples;
}

/// Layers beyond the reference trace's first and last sample that other traces need to be covered.
struct Margins {
  std::int32_t above = 0, below = 0;
};

/// Where the reference trace's first and last sample lie on the others says how many.
Result<Margins> find_margins(const DipField& field, const PaintOrder& order, const Progress& progress) {
  LayerDepths ends{.shape = field.shape(), .layers = 2, .spacing = std::max(field.shape().samples - 1, 1)};
  if (auto painted = paint_layers(field, order, progress, ends); !painted) return std::move(painted).error();
  float highest = 0, lowest = static_cast<float>(ends.spacing);
  for (std::size_t t = 0; t < ends.trace_count(); ++t) {
    highest = std::max(highest, ends.trace(t)[0]);
    lowest = std::min(lowest, ends.trace(t)[1]);
  }
  return Margins{static_cast<std::int32_t>(std::ceil(highest)),
                 static_cast<std::int32_t>(std::ceil(static_cast<float>(ends.spacing) - lowest))};
}

std::int32_t most_layers(GridShape shape, const StructureOptions& options) {
  const std::int64_t limit = std::int64_t{shape.samples} * options.most_layers_a_sample;
  return static_cast<std::int32_t>(std::min<std::int64_t>(limit, kMaxAxisNodes));
}

std::int32_t choose_spacing(GridShape shape, std::int64_t layers, const StructureOptions& options) {
  if (options.layer_spacing > 0) return options.layer_spacing;
  const std::int64_t traces = std::int64_t{shape.inlines} * shape.crosslines;
  const std::int64_t most = std::max(kFewNodes, shape.count() / 5);
  std::int32_t spacing = 1;
  while (spacing < kWidestSpacing && traces * (layers / spacing + 2) > most) spacing *= 2;
  return spacing;
}

/// Layers to be painted and polished, before they have depths.
Result<LayerDepths> plan_layers(const DipField& field, const PaintOrder& order, const StructureOptions& options,
                                const Progress& progress) {
  const GridShape shape = field.shape();
  const auto margins = find_margins(field, order, progress);
  if (!margins) return margins.error();
  const std::int64_t layers = std::int64_t{margins->above} + shape.samples + margins->below;
  if (layers > most_layers(shape, options)) {
    return Error{ErrorCode::limit_exceeded, "the structural grid needs at least " + std::to_string(layers) +
                                                " layers for " + std::to_string(shape.samples) + " samples; at most " +
                                                std::to_string(most_layers(shape, options))};
  }
  LayerDepths depths{.shape = shape, .spacing = choose_spacing(shape, layers, options)};
  depths.first = -(margins->above + depths.spacing - 1) / depths.spacing * depths.spacing;
  const std::int64_t painted = (layers - margins->above - depths.first - 2) / depths.spacing + 2;
  depths.layers = static_cast<std::int32_t>(std::max<std::int64_t>(painted, 2));  // places lie between two
  return depths;
}

/// The least agreement of a trace's links at every fourth sample.
void fill_agreement(const DipField& field, int threads, StructuralGrid& grid) {
  const auto count = static_cast<std::size_t>(field.agreements());
  grid.agreement.assign(field.trace_count() * count, 255);
  parallel_for(static_cast<std::size_t>(field.shape().inlines), threads, [&](std::size_t plane) {
    const auto i = static_cast<std::int32_t>(plane);
    for (std::int32_t j = 0; j < field.shape().crosslines; ++j) {
      std::uint8_t* least = &grid.agreement[field.trace_of(i, j) * count];
      const auto take = [&](std::int32_t a, std::int32_t b, LinkAxis axis) {
        if (a < 0 || b < 0 || !field.has_link(a, b, axis)) return;
        const std::uint8_t* agreement = field.agreements(field.trace_of(a, b), axis);
        for (std::size_t m = 0; m < count; ++m) least[m] = std::min(least[m], agreement[m]);
      };
      for (const LinkAxis axis : kLinkAxes) take(i, j, axis);
      take(i - 1, j, LinkAxis::inline_);
      take(i, j - 1, LinkAxis::crossline);
    }
  });
}

/// Of places that agree at all.
double share_below_half(const std::vector<std::uint8_t>& agreement) {
  std::int64_t all = 0, below = 0;
  for (const std::uint8_t a : agreement) {
    all += a > 0;
    below += a > 0 && a < 128;
  }
  return all == 0 ? 0 : static_cast<double>(below) / static_cast<double>(all);
}

/// Of links within the box that agree at all: those whose layers are off by more than half a sample.
double untied_share(const DipField& field, const LayerDepths& depths, int threads) {
  struct Count {
    std::int64_t all = 0, untied = 0;
  };
  const auto bottom = static_cast<float>(depths.shape.samples - 1);
  std::vector<Count> of_plane(static_cast<std::size_t>(depths.shape.inlines));
  parallel_for(of_plane.size(), threads, [&](std::size_t plane) {
    const auto i = static_cast<std::int32_t>(plane);
    for (std::int32_t j = 0; j < depths.shape.crosslines; ++j) {
      for (const LinkAxis axis : kLinkAxes) {
        if (!field.has_link(i, j, axis)) continue;
        const std::size_t trace = field.trace_of(i, j);
        const float* here = depths.trace(trace);
        const float* next = depths.trace(axis == LinkAxis::inline_ ? field.trace_of(i + 1, j) : trace + 1);
        for (std::int32_t l = 0; l < depths.layers; ++l) {
          const float middle = 0.5f * (here[l] + next[l]);
          if (middle < 0 || middle > bottom || !(field.agreement(trace, axis, middle) > 0)) continue;
          ++of_plane[plane].all;
          if (std::abs(next[l] - here[l] - field.dip(trace, axis, middle)) > 0.5f) ++of_plane[plane].untied;
        }
      }
    }
  });
  Count sum;
  for (const Count& count : of_plane) sum = {sum.all + count.all, sum.untied + count.untied};
  return sum.all == 0 ? 0 : static_cast<double>(sum.untied) / static_cast<double>(sum.all);
}

}  // namespace

Result<MeasuredDips> measure_dips(const DipSamples& input, int threads, Progress& progress) {
  MeasuredDips measured;
  auto scan = scan_vertically(measured_of(input), threads, progress);
  if (!scan) return std::move(scan).error();
  measured.scan = *scan;
  auto field = scan_dips(input, *scan, threads, progress, phase(progress, 0, 0.1));
  if (!field) return std::move(field).error();
  measured.field = *std::move(field);
  measured.report.period = scan->period;
  if (share_steeper_than(measured.field, kSteepShare * scan->period) > kFewSteep) {
    auto warped = warp_dips(measured_of(input), *scan, threads, progress, phase(progress, 0.1, 0.3), measured.field);
    if (!warped) return std::move(warped).error();
    measured.report.warped = true;
  }
  measured.report.dips = dip_quantiles(measured.field);
  return measured;
}

Result<LayerDepths> lay_layers(const DipField& field, const StructureOptions& options, Progress& progress) {
  const PaintOrder order = order_traces(field, options.threads);
  auto depths = plan_layers(field, order, options, progress);
  if (!depths) return depths;
  if (auto painted = paint_layers(field, order, progress, *depths); !painted) return std::move(painted).error();
  auto polished = polish_layers(field, *depths, options.threads, progress, phase(progress, 0.55, 0.95));
  if (!polished) return std::move(polished).error();
  return depths;
}

Result<StructuralGrid> build_structural_grid(const DipSamples& input, const StructureOptions& options,
                                             Progress& progress) {
  auto measured = measure_dips(input, options.threads, progress);
  if (!measured) return std::move(measured).error();
  DipField& field = measured->field;
  spread_dips(field, options.threads);
  auto agreed =
      scan_agreements(measured_of(input), measured->scan, options.threads, progress, phase(progress, 0.3, 0.5), field);
  if (!agreed) return std::move(agreed).error();
  StructuralGrid grid;
  grid.report.dips = measured->report;
  fill_agreement(field, options.threads, grid);
  grid.report.unreliable_share = share_below_half(grid.agreement);
  auto depths = lay_layers(field, options, progress);
  if (!depths) return std::move(depths).error();
  grid.report.untied_share = untied_share(field, *depths, options.threads);
  field = DipField();
  auto paths = whole_paths(*depths, most_layers(input.samples.shape(), options), options.threads);
  if (!paths) return std::move(paths).error();
  grid.paths = *std::move(paths);
  progress.report(kStage, 1);
  return grid;
}

}  // namespace geosis
