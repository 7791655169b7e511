#pragma once

#include <list>
#include <memory>
#include <mutex>
#include <string>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/structure/structural_grid.h"
#include "server/app/derived/key_turns.h"
#include "server/app/volumes/volumes.h"
#include "server/store/blob_store.h"

namespace geosis::server {

/// Structural grids and dips as derived objects of a volume: computed once and kept, so that another range does not lay
/// the grid again. Any thread may call any member.
///
/// Stored under <tenant>/volumes/<id>/structures/<result version>-grid and -dips.json.
class Structures {
 public:
  /// threads   that one computation may use.
  Structures(BlobStore& store, std::string tenant, int threads);

  /// The grid: from memory, from the store, or laid here. Whoever asks for what is being laid waits.
  ///
  /// errors   those of lay_structural_grid and of the store; cancelled.
  Result<std::shared_ptr<const StructuralGrid>> grid(const StoredVolume& volume, Progress& progress);
  /// The dips alone, likewise.
  Result<DipReport> dips(const StoredVolume& volume, Progress& progress);
  /// Removes both of a volume.
  Result<void> remove(const std::string& volume);

 private:
  BlobKey folder(const std::string& volume) const { return tenant_ + "/volumes/" + volume + "/structures/"; }
  std::shared_ptr<const StructuralGrid> recent(const BlobKey& key);
  void remember(const BlobKey& key, std::shared_ptr<const StructuralGrid> grid);
  Result<StructuralGrid> load_or_lay(const BlobKey& key, const StoredVolume& volume, Progress& progress);

  struct Recent {
    BlobKey key;
    std::shared_ptr<const StructuralGrid> grid;
  };

  BlobStore& store_;
  const std::string tenant_;
  const int threads_;
  KeyTurns turns_;
  std::mutex mutex_;          // of recent_
  std::list<Recent> recent_;  ///< most recently used first
};

}  // namespace geosis::server
