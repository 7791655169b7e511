#pragma once

#include <memory>
#include <optional>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/mesh/indexed_mesh.h"
#include "engine/mesh/lod_hierarchy.h"
#include "engine/simplify/build_lods.h"
#include "engine/simplify/reducer.h"
#include "engine/simplify/specks.h"
#include "engine/simplify/watch.h"
#include "engine/simplify/window_sizes.h"

namespace geosis {

/// Makes one level after the other, each from the one before. Keeps references to M0 and the options.
class LevelBuilder {
 public:
  LevelBuilder(const IndexedMesh& m0, const BuildLodsOptions& options, const WindowSizes& sizes, Progress& progress);

  /// The next level; nothing when it is asked for by an error that the mesh as it is exceeds already.
  Result<std::optional<LodLevel>> make(const LevelTarget& target);

  /// Goes back to M0, without what was dropped.
  Result<void> begin_anew();

  /// The mesh as it is.
  LodLevel as_it_is() const;

 private:
  Result<void> drop(const DropSpecks& limits);
  Result<void> remove_dropped();
  Result<LodLevel> make_for(const LevelTarget& target);
  Result<std::optional<LodLevel>> make_within(double max_error);
  Result<void> end_of(PassEnd end) const;

  const IndexedMesh& m0_;
  const BuildLodsOptions& options_;
  Watch watch_;
  const ReducerOptions reducer_options_;
  Reducer reducer_;
  std::unique_ptr<Specks> specks_;
};

}  // namespace geosis
