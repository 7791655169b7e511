#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/volume/bricks.h"
#include "engine/volume/formats/import.h"
#include "server/app/byte_stream.h"
#include "server/documents/json_text.h"
#include "server/store/blob_store.h"

namespace geosis::server {

/// A volume that is stored and mapped: what extraction, slices and histogram read.
struct StoredVolume {
  std::string id;
  VolumeDescription description;
  std::shared_ptr<const BrickedVolume> samples;
};

struct UploadOptions {
  ImportOptions import;
  std::string name;
};

struct UploadResult {
  std::string id;
  bool is_new = true;
  Json document;
};

enum class SliceAxis { inline_, crossline, sample };

struct Slice {
  std::int32_t rows = 0, columns = 0;
  std::vector<float> samples;  ///< (rows, columns); NaN = missing
};

/// Use cases around volumes, without any transport.
///
/// Stored under <tenant>/volumes/<id>/: bricks (the brick file), sidecar.json, and volume.json, written last: a volume
/// is there when its volume.json is.
class Volumes {
 public:
  Volumes(BlobStore& store, std::string tenant, int threads);

  /// A file being received: bytes are spooled into the store's staging and hashed.
  class Upload {
   public:
    virtual ~Upload() = default;
    virtual Result<void> write(std::span<const std::byte> bytes) = 0;
    /// Imports what was received. candidates as import_volume fills them.
    virtual Result<UploadResult> finish(Progress& progress, std::vector<GridCandidate>& candidates) = 0;
  };
  /// declared_bytes   from the transport when known: refused early when the disk cannot hold it.
  /// digest           expected SHA-256 (hexadecimal) of the bytes, if the client sent one.
  Result<std::unique_ptr<Upload>> begin_upload(const UploadOptions& options,
                                               std::optional<std::uint64_t> declared_bytes,
                                               std::optional<std::string> digest);

  Result<std::shared_ptr<const StoredVolume>> open(const std::string& id);
  Result<Json> document(const std::string& id) const;
  /// {"volumes": [...], "next_page_token": ...}
  Result<Json> list(std::size_t page_size, const std::string& page_token) const;
  /// JSON merge patch of the sidecar: name, crs.
  Result<Json> patch(const std::string& id, const Json& changes);
  Result<void> remove(const std::string& id);

  /// {"edges": [bins + 1], "counts": [bins], "missing": n}
  Result<Json> histogram(const std::string& id, int bins);
  Result<Slice> slice(const std::string& id, SliceAxis axis, std::int32_t index);
};

}  // namespace geosis::server
