#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/base/vec3.h"
#include "engine/structure/layer_depths.h"
#include "engine/structure/layer_paths.h"
#include "engine/structure/scan_dips.h"
#include "engine/volume/bricks.h"

namespace geosis {

/// What is known of a volume's reflectors before any grid is laid.
struct DipReport {
  double period = 0;                      ///< dominant vertical period, in samples; 0 without contrast
  std::array<DipQuantiles, 2> dips = {};  ///< sizes of dips from inline to inline and from crossline to crossline
  bool warped = false;  ///< reflectors steeper than a quarter of the period a trace: traces were warped to each other
  bool operator==(const DipReport&) const = default;
};

/// How far the layers of a structural grid are to be trusted.
struct StructureReport {
  DipReport dips;
  /// Of samples whose trace agrees with all its neighbours at all: the least of these agreements is below one half.
  double unreliable_share = 0;
  double untied_share = 0;  ///< of links between layers: off by more than half a sample from the dip measured there
  bool operator==(const StructureReport&) const = default;
};

/// A grid whose layers follow the reflectors, found from the samples. Node (i, j, u) is sample (i, j,
/// paths.sample_at(i, j, u)): values and positions are the measured ones, only the joins between traces are others.
struct StructuralGrid {
  static constexpr std::int32_t kAgreementSpacing = 4;

  LayerPaths paths;
  /// (inlines, crosslines, (samples - 1) / 4 + 1): the least agreement, in 1/255, of the links of the trace, at every
  /// fourth sample; 0 where the trace is missing.
  std::vector<std::uint8_t> agreement;
  StructureReport report;
};

/// How well traces agree around places among the samples, in 1/255: mixed trilinearly from grid.agreement.
std::vector<std::uint8_t> agreement_at(const StructuralGrid& grid, std::span<const Vec3f> positions, int threads);

struct StructureOptions {
  std::int32_t most_layers_a_sample = 8;  ///< the limit is so many times the volume's samples a trace
  std::int32_t layer_spacing = 0;         ///< layers between those that are solved for; 0 = chosen by the volume's size
  int threads = 1;
};

/// Lays a structural grid: dips, agreements, painting, polishing, whole paths. Missing traces and surveys that are no
/// rectangle have layers too, carried on from their neighbours.
///
/// input    dips are best found where gaps are filled, for instance linearly.
/// errors   limit_exceeded: more layers than the limit, or than an axis may have.  malformed_input: a damaged brick.
///          cancelled.
/// cost     docs/structural-grid.md has times. Memory: 2.5 bytes a sample for dips, 28 a node of the layers solved for,
///          at most 8 a sample; then a quarter of a byte a sample for the result and one bit a node. The same for any
///          number of threads.
Result<StructuralGrid> build_structural_grid(const DipSamples& input, const StructureOptions& options,
                                             Progress& progress);

/// The first half of that alone: dips of all links, and what they say. Agreements are 0.
struct MeasuredDips {
  DipField field;
  VerticalScan scan;
  DipReport report;
};
Result<MeasuredDips> measure_dips(const DipSamples& input, int threads, Progress& progress);

/// The second half: layers of real depths from dips and agreements, painted and polished.
Result<LayerDepths> lay_layers(const DipField& field, const StructureOptions& options, Progress& progress);

}  // namespace geosis
