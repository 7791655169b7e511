#pragma once

#include <memory>
#include <optional>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/pipeline/reconstruct.h"
#include "engine/structure/layer_map.h"
#include "engine/structure/structural_grid.h"
#include "engine/volume/bricks.h"

namespace geosis {

/// A volume's structural grid: a function of its measured samples alone, whatever a request fills or wants. For the
/// sake of its dips, gaps are filled linearly.
///
/// errors   those of build_structural_grid and fill_missing.
Result<StructuralGrid> lay_structural_grid(const BrickedVolume& measured, int threads, Progress& progress);

/// The dips alone; what `auto` decides by.
Result<DipReport> report_dips(const BrickedVolume& measured, int threads, Progress& progress);

/// Whether reflectors are so steep that joining samples along them is worth more cells: 95 % of the dips are less steep
/// than an eighth of the dominant period a trace, on both axes, where it is not.
bool prefers_structure(const DipReport& dips);

/// The grid that a reconstruction connects samples on.
struct StageGrid {
  const StructuralGrid* structural = nullptr;  ///< null: the axis grid
  std::unique_ptr<const StructuralGrid> made;  ///< keeps a grid that nobody had before
  std::optional<GridReport> report;            ///< unset where the options ask for the axis grid
};

/// Before anything else: the grid that the options ask for, the input's own where it has one.
Result<StageGrid> grid_stage(const ReconstructInput& input, const ReconstructOptions& options, Progress& progress);

/// The structural grid's layers, cut to the options' region; unset on the axis grid. Refers to the stage's grid.
std::optional<LayerMap> layer_map(const StageGrid& grid, GridShape shape, const ReconstructOptions& options);

}  // namespace geosis
