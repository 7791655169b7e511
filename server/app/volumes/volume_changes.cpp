#include <utility>

#include "server/app/volumes/volume_blobs.h"
#include "server/app/volumes/volumes.h"

// What changes and removes volumes, and what is left when that is cut short.

namespace geosis::server {
namespace {

/// How often another process may come first between looking and changing. Each time takes the right moment.
constexpr int kMaxAttempts = 1000;

Error busy(const std::string& id) {
  return {ErrorCode::unavailable, "volume " + id + ": too many changes at one time"};
}

/// Name and crs, strings or null, and nothing else.
Result<void> check_changes(const Json& changes) {
  if (!changes.is_object()) return Error{ErrorCode::invalid_argument, "/: expected an object"};
  for (const auto& [name, value] : changes.items()) {
    if (name != "name" && name != "crs") return Error{ErrorCode::invalid_argument, "/" + name + ": cannot be changed"};
    if (!value.is_string() && !value.is_null()) {
      return Error{ErrorCode::invalid_argument, "/" + name + ": " + value.dump() + "; expected a string or null"};
    }
  }
  return {};
}

}  // namespace

Result<Json> Volumes::change(const std::string& id, const Json& changes) {
  for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
    const auto volume = read_document(id, kVolume);
    if (!volume) return volume;
    if (auto checked = check_changes(changes); !checked) return std::move(checked).error();
    const BlobKey sidecar = key(id, data_folder(*volume) + kSidecar);
    const auto now = store_.get_versioned(sidecar);
    if (!now && now.error().code == ErrorCode::not_found) continue;  // the volume goes, or is replaced
    if (!now) return now.error();
    auto merged = parse_json({reinterpret_cast<const char*>(now->bytes.data()), now->bytes.size()});
    if (!merged) return merged;
    for (const auto& [name, value] : changes.items()) (*merged)[name] = value;
    const auto is_done = store_.put_if(sidecar, bytes_of(document_text(*merged)), now->version);
    if (!is_done) return is_done.error();
    if (*is_done) return public_document(*volume, *merged);
  }
  return busy(id);
}

Result<void> Volumes::remove(const std::string& id) {
  const auto volume = read_document(id, kVolume);
  if (!volume && volume.error().code != ErrorCode::internal) return volume.error();
  if (auto done = store_.remove(key(id, kVolume)); !done) return done;
  forget(id);  // after it is gone: nobody opens it again
  if (!volume) return collect_garbage_of(id);
  return remove_upload(id, volume->value(kUpload, ""));
}

Result<void> Volumes::remove_upload(const std::string& id, const std::string& upload) {
  const std::string folder = upload_folder(upload);
  for (const char* name : {kSidecar, kBricks}) {
    if (auto done = store_.remove(key(id, folder + name)); !done) return done;
  }
  return {};
}

Result<void> Volumes::collect_garbage() {
  const auto ids = store_.children(tenant_ + "/volumes/");
  if (!ids) return ids.error();
  for (const std::string& id : *ids) {
    if (!is_id(id)) continue;
    if (auto done = collect_garbage_of(id); !done) return done;
    const auto is_there = store_.exists(key(id, kVolume));
    if (!is_there) return is_there.error();
    const auto uploads = store_.children(key(id, kUploads));
    if (!uploads) return uploads.error();
    const bool is_gone = !*is_there && uploads->empty();  // and not just being replaced because it is damaged
    if (auto done = is_gone ? grids_.remove_all(id) : grids_.collect_garbage_of(id); !done) return done;
  }
  return {};
}

Result<void> Volumes::collect_garbage_of(const std::string& id) {
  // Uploads before volume.json: one that ends in between has its folder named there.
  const auto uploads = store_.children(key(id, kUploads));
  if (!uploads) return uploads.error();
  for (const std::string& upload : *uploads) {
    const std::string process = process_of(upload);
    if (process != store_.process_name() && store_.may_be_running(process)) continue;
    {
      const std::lock_guard lock(mutex_);
      if (uploads_.contains(upload)) continue;
    }
    const auto volume = read_document(id, kVolume);
    if (!volume && volume.error().code != ErrorCode::not_found) return {};  // not known which one counts
    if (volume && volume->value(kUpload, "") == upload) continue;
    if (auto done = remove_upload(id, upload); !done) return done;
  }
  return {};
}

}  // namespace geosis::server
