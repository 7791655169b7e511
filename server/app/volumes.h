#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "engine/analysis/histogram.h"
#include "engine/base/result.h"
#include "engine/volume/bricks.h"
#include "engine/volume/formats/import.h"
#include "engine/volume/slice.h"
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
  std::string name;                   ///< what people call it; may be empty
  std::optional<std::string> digest;  ///< SHA-256 of the file as the client knows it, hexadecimal
};

struct UploadResult {
  bool is_new = true;  ///< false: the same file was here already, read with the same options
  Json document;
};

/// Use cases around volumes, without any transport. Any thread may call any member.
///
/// Stored under <tenant>/volumes/<id>/: `bricks` (the brick file), `sidecar.json` (name, crs, created_at) and
/// `volume.json`, written last and removed first: a volume is there when its volume.json is.
class Volumes {
 public:
  /// threads   that imports and histograms may use.
  Volumes(BlobStore& store, std::string tenant, int threads);

  /// Imports a received file. The file itself is not kept.
  ///
  /// candidates   filled as import_volume does.
  /// errors       those of import_volume; invalid_argument: the digest is another; those of the store.
  Result<UploadResult> add(const ByteSource& file, const UploadOptions& options, Progress& progress,
                           std::vector<GridCandidate>& candidates);

  Result<std::shared_ptr<const StoredVolume>> open(const std::string& id);
  /// The volume document of the outside contract.
  Result<Json> document(const std::string& id) const;
  /// {"volumes": [...], "next_page_token": string or null}, in the order of ids.
  Result<Json> list(std::size_t page_size, const std::string& page_token) const;
  /// Changes name and crs of the sidecar; null removes. errors: invalid_argument: another field, not a string.
  Result<Json> change(const std::string& id, const Json& changes);
  /// Forgets the volume. What was derived from it is Extractions' to remove.
  Result<void> remove(const std::string& id);

  Result<Histogram> histogram(const std::string& id, int bins, Progress& progress);
  Result<Slice> slice(const std::string& id, SliceAxis axis, std::int32_t index);

 private:
  BlobKey key(const std::string& id, const char* name) const { return tenant_ + "/volumes/" + id + "/" + name; }
  Result<Json> read_document(const std::string& id, const char* name) const;
  Result<void> write_document(const std::string& id, const char* name, const Json& document);

  BlobStore& store_;
  const std::string tenant_;
  const int threads_;
  std::mutex writing_;                                     ///< of what makes, changes or removes volumes
  std::mutex mutex_;                                       ///< of recent_
  std::list<std::shared_ptr<const StoredVolume>> recent_;  ///< most recently opened first
};

/// 64 lower-case hexadecimal digits: what ids look like.
bool is_id(const std::string& text);

/// The present moment as documents show it: 2026-01-31T12:00:00Z.
std::string timestamp();

}  // namespace geosis::server
