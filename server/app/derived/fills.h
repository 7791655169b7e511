#pragma once

#include <list>
#include <memory>
#include <mutex>
#include <string>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/missing/fill.h"
#include "server/app/derived/file_identity.h"
#include "server/app/derived/key_turns.h"
#include "server/app/volumes/volumes.h"
#include "server/store/blob_store.h"

namespace geosis::server {

/// A stored volume with its missing samples filled.
struct FilledStoredVolume {
  std::shared_ptr<const StoredVolume> volume;  ///< what `samples` refers to
  std::unique_ptr<const FilledVolume> samples;
};

/// Filled samples as derived objects of a volume: each way of filling is computed once and kept, so that another range
/// does not fill again. Any thread may call any member.
///
/// Stored under <tenant>/volumes/<id>/fills/<result version>-<way of filling>.
class Fills {
 public:
  /// threads   that one fill may use.
  Fills(BlobStore& store, std::string tenant, int threads);

  /// The filled volume: from memory, from the store, or computed here. Whoever asks for what is being computed waits.
  ///
  /// errors   those of fill_missing and of the store; cancelled.
  Result<std::shared_ptr<const FilledStoredVolume>> fill(std::shared_ptr<const StoredVolume> volume,
                                                         const FillOptions& options, Progress& progress);
  /// Removes all that was filled of a volume.
  Result<void> remove(const std::string& volume);

 private:
  BlobKey folder(const std::string& volume) const { return tenant_ + "/volumes/" + volume + "/fills/"; }
  std::shared_ptr<const FilledStoredVolume> recent(const BlobKey& key);
  void remember(const BlobKey& key, std::shared_ptr<const FilledStoredVolume> filled);
  Result<std::unique_ptr<FilledVolume>> load_or_fill(const BlobKey& key, const BrickedVolume& samples,
                                                     const FillOptions& options, Progress& progress);
  Result<void> fill_into_store(const BlobKey& key, const BrickedVolume& samples, const FillOptions& options,
                               Progress& progress);

  struct Recent {
    BlobKey key;
    std::shared_ptr<const FilledStoredVolume> filled;
    FileIdentity identity;
  };

  BlobStore& store_;
  const std::string tenant_;
  const int threads_;
  KeyTurns turns_;
  std::mutex mutex_;          // of recent_
  std::list<Recent> recent_;  ///< most recently used first
};

}  // namespace geosis::server
