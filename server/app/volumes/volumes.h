#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "engine/analysis/histogram.h"
#include "engine/base/result.h"
#include "engine/volume/bricks.h"
#include "engine/volume/formats/import.h"
#include "engine/volume/slice.h"
#include "server/app/derived/file_identity.h"
#include "server/app/derived/grids.h"
#include "server/documents/ids.h"
#include "server/documents/json_text.h"
#include "server/documents/volume_document.h"
#include "server/store/blob_store.h"

namespace geosis::server {

/// A volume in the store, mapped: what extraction, slices and histogram read.
struct StoredVolume {
  VolumeSummary summary;
  std::unique_ptr<const BrickedVolume> samples;
};

struct UploadOptions {
  ImportOptions import;
  std::function<Result<void>()> confirm = {};  ///< asked once the file is read, before anything of it is kept
  std::string name;                            ///< what people call it; may be empty
};

struct UploadResult {
  bool is_new = true;  ///< false: the same file was here already, read with the same options
  Json document;
};

/// Use cases around volumes, without any transport. Any thread of any process on the store may call any member.
///
/// Stored under <tenant>/volumes/<id>/: `data/<upload>/bricks` (the brick file) and `data/<upload>/sidecar.json` (name,
/// crs, created_at), in a folder that no other upload shares, and `volume.json`, which names that folder, written last
/// and removed first: a volume is there when its volume.json is. docs/store.md tells what follows from that.
class Volumes {
 public:
  /// threads   that imports and histograms may use.
  Volumes(BlobStore& store, std::string tenant, int threads);

  /// Imports a received file. The file itself is not kept. Of equal uploads at one time, by whatever process, one is
  /// kept; one whose stored samples were found damaged is replaced.
  ///
  /// candidates   filled as import_volume does.
  /// errors       those of import_volume, of options.confirm and of the store.
  Result<UploadResult> add(const ByteSource& file, const UploadOptions& options, Progress& progress,
                           std::vector<GridCandidate>& candidates);

  const std::string& tenant() const { return tenant_; }
  /// Grids that belong to the volumes.
  Grids& grids() { return grids_; }

  /// errors   not_found.  internal: what is stored is damaged.
  Result<std::shared_ptr<const StoredVolume>> open(const std::string& id);
  /// The volume document of the outside contract.
  Result<Json> document(const std::string& id) const;
  /// {"volumes": [...], "next_page_token": string or null}, in the order of ids; without those that are damaged.
  Result<Json> list(std::size_t page_size, const std::string& page_token) const;
  /// Changes name and crs of the sidecar; null removes. Changes at one time, by whatever process, all take effect.
  /// errors: invalid_argument: another field, not a string.
  Result<Json> change(const std::string& id, const Json& changes);
  /// Forgets the volume. What was derived from it is Extractions' to remove, and its grids stay until somebody removes
  /// them: a damaged volume that is uploaded again has them still.
  Result<void> remove(const std::string& id);

  Result<Histogram> histogram(const std::string& id, int bins, Progress& progress);
  /// index   a node number, from 0; whoever gives the survey's own number instead is told which node that is.
  Result<Slice> slice(const std::string& id, SliceAxis axis, std::int32_t index);

  /// What an error that came while reading a volume's samples says to a client: damage is ours, not his. Reported to
  /// the store, and the volume's next upload replaces it.
  Error judged(const std::string& id, Error error);

  /// Removes what uploads of processes that are gone left without a volume.json, and grids of volumes that are gone.
  Result<void> collect_garbage();

 private:
  class Upload;
  struct Opened {
    std::shared_ptr<const StoredVolume> volume;
    std::filesystem::path path;
    FileIdentity identity;
    std::chrono::steady_clock::time_point at;
  };

  BlobKey key(const std::string& id, const std::string& name) const { return tenant_ + "/volumes/" + id + "/" + name; }
  Result<Json> read_document(const std::string& id, const std::string& name) const;
  Result<Json> read_sidecar(const std::string& id, const Json& volume) const;
  std::string which_node(const std::string& id, SliceAxis axis, std::int32_t number) const;
  Result<UploadResult> keep(std::unique_ptr<StagedFile> bricks, const VolumeDescription& description,
                            const std::string& name);
  /// True when volume.json is this upload's now; false when there is another one.
  Result<bool> store(const std::string& id, std::unique_ptr<StagedFile> bricks, const VolumeDescription& description,
                     const std::string& name);
  std::shared_ptr<const StoredVolume> recent(const std::string& id);
  void forget(const std::string& id);
  Result<void> remove_upload(const std::string& id, const std::string& upload);
  Result<void> collect_garbage_of(const std::string& id);

  BlobStore& store_;
  const std::string tenant_;
  const int threads_;
  Grids grids_;
  std::mutex mutex_;               ///< of what follows
  std::list<Opened> recent_;       ///< most recently opened first
  std::set<std::string> uploads_;  ///< of this process, whose volume.json may still be missing
  std::set<std::string> damaged_;  ///< ids
};

/// The present moment as documents show it: 2026-01-31T12:00:00Z.
std::string timestamp();

}  // namespace geosis::server
