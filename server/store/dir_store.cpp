#include "server/store/dir_store.h"

#include <algorithm>
#include <cerrno>
#include <limits>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>

#include "server/store/blob_file.h"
#include "server/store/blob_key.h"
#include "server/store/blob_trailer.h"
#include "server/store/folder_tree.h"
#include "server/store/key_locks.h"
#include "server/store/key_walk.h"
#include "server/store/open_file.h"
#include "server/store/staging_area.h"

namespace geosis::server {
namespace {

namespace fs = std::filesystem;

// How often a folder may be removed by others between being made and being used. Each time takes a removal at the
// right moment, so this ends a loop that would mean something else is wrong.
constexpr int kMaxAttempts = 100;

Error no_such_blob(const BlobKey& key) {
  return {ErrorCode::not_found, "no blob \"" + key + "\""};
}

/// Equal bytes have the same version, so a change there and back is not seen: what changes names whoever changed it.
std::string version_of(std::span<const std::byte> bytes) {
  const BlobTrailer trailer = trailer_of(bytes);
  return std::to_string(trailer.length) + "-" + std::to_string(trailer.checksum);
}

class DirStore final : public BlobStore {
 public:
  DirStore(FileCalls& calls, const fs::path& root, std::unique_ptr<StagingArea> staging)
      : calls_(calls),
        objects_(root / "objects"),
        folders_(calls, objects_),
        locks_(calls, root / "locks"),
        staging_(std::move(staging)) {}

  Result<void> put(const BlobKey& key, std::span<const std::byte> bytes) override;
  Result<std::vector<std::byte>> get(const BlobKey& key) const override;
  Result<VersionedBlob> get_versioned(const BlobKey& key) const override;
  Result<bool> put_if(const BlobKey& key, std::span<const std::byte> bytes, const std::string& version) override;
  Result<bool> exists(const BlobKey& key) const override;
  Result<std::vector<BlobKey>> list(std::string_view prefix, std::string_view after, std::size_t limit) const override;
  Result<std::vector<BlobInfo>> inventory(std::string_view prefix) const override;
  void touch(const BlobKey& key) override;
  Result<std::vector<std::string>> children(std::string_view prefix) const override;
  Result<void> remove(const BlobKey& key) override;
  Result<std::unique_ptr<StagedFile>> stage() override { return staging_->stage(); }
  Result<void> commit(std::unique_ptr<StagedFile> file, const BlobKey& key) override;
  Result<fs::path> local_file(const BlobKey& key) const override;
  std::string process_name() const override { return staging_->process_name(); }
  bool may_be_running(const std::string& process) const override { return staging_->may_be_running(process); }

 private:
  Result<void> place(const StagedFile& file, const BlobKey& key);
  Result<void> move(const fs::path& staged, const fs::path& target);

  FileCalls& calls_;
  const fs::path objects_;
  FolderTree folders_;
  KeyLocks locks_;
  std::unique_ptr<StagingArea> staging_;
};

Result<void> DirStore::put(const BlobKey& key, std::span<const std::byte> bytes) {
  if (auto checked = check_key(key); !checked) return checked;
  const auto file = staging_->stage();
  if (!file) return file.error();
  if (auto written = write_blob_file(calls_, (*file)->path(), bytes); !written) return written;
  return place(**file, key);
}

Result<bool> DirStore::put_if(const BlobKey& key, std::span<const std::byte> bytes, const std::string& version) {
  if (auto checked = check_key(key); !checked) return std::move(checked).error();
  const auto file = staging_->stage();
  if (!file) return file.error();
  if (auto written = write_blob_file(calls_, (*file)->path(), bytes); !written) return std::move(written).error();
  const auto turn = locks_.take(key);
  if (!turn) return turn.error();
  const auto now = get_versioned(key);
  if (!now && now.error().code != ErrorCode::not_found) return now.error();
  if ((now ? now->version : "") != version) return false;
  if (auto placed = place(**file, key); !placed) return std::move(placed).error();
  return true;
}

Result<void> DirStore::commit(std::unique_ptr<StagedFile> file, const BlobKey& key) {
  if (auto checked = check_key(key); !checked) return checked;
  if (!file || !staging_->owns(*file))
    return Error{ErrorCode::invalid_argument, "the file for \"" + key + "\" was not staged in this store"};
  if (auto flushed = flush_file(calls_, file->path()); !flushed) return flushed;
  return place(*file, key);
}

// Moves a flushed file to its key and makes that durable. When that fails, a key that was not there before is not there
// afterwards: what is visible counts as stored.
Result<void> DirStore::place(const StagedFile& file, const BlobKey& key) {
  const fs::path target = objects_ / key;
  struct stat status {};
  const bool is_new = calls_.lstat(target.c_str(), &status) != 0 && errno == ENOENT;
  auto placed = move(file.path(), target);
  if (placed) {
    placed = folders_.flush(target.parent_path());
    if (!placed && is_new) calls_.unlink(target.c_str());
  }
  if (!placed) folders_.remove_empty(target.parent_path());
  return placed;
}

Result<void> DirStore::move(const fs::path& staged, const fs::path& target) {
  for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
    if (calls_.rename(staged.c_str(), target.c_str()) == 0) return {};
    if (errno == EISDIR || errno == ENOTDIR)
      return Error{ErrorCode::invalid_argument, target.string() + ": a blob's name cannot be a folder of others"};
    if (errno != ENOENT) break;
    if (auto made = folders_.make(target.parent_path()); !made) return made;
    errno = ENOENT;
  }
  return file_error(target, "cannot write", errno);
}

Result<std::vector<std::byte>> DirStore::get(const BlobKey& key) const {
  if (auto checked = check_key(key); !checked) return checked.error();
  auto bytes = read_blob_file(calls_, objects_ / key);
  if (bytes) return bytes;
  if (bytes.error().code == ErrorCode::not_found) return no_such_blob(key);
  if (bytes.error().code != ErrorCode::malformed_input) return bytes;
  report_damage(key, bytes.error().message);
  return Error{ErrorCode::internal, "blob \"" + key + "\" is damaged: " + bytes.error().message};
}

Result<VersionedBlob> DirStore::get_versioned(const BlobKey& key) const {
  auto bytes = get(key);
  if (!bytes) return std::move(bytes).error();
  std::string version = version_of(*bytes);
  return VersionedBlob{*std::move(bytes), std::move(version)};
}

Result<bool> DirStore::exists(const BlobKey& key) const {
  if (auto checked = check_key(key); !checked) return checked.error();
  const fs::path path = objects_ / key;
  struct stat status {};
  if (calls_.lstat(path.c_str(), &status) == 0) return S_ISREG(status.st_mode);
  if (errno == ENOENT || errno == ENOTDIR) return false;
  return file_error(path, "cannot look", errno);
}

Result<fs::path> DirStore::local_file(const BlobKey& key) const {
  const auto found = exists(key);
  if (!found) return found.error();
  if (!*found) return no_such_blob(key);
  return objects_ / key;
}

Result<std::vector<BlobKey>> DirStore::list(std::string_view prefix, std::string_view after, std::size_t limit) const {
  if (auto checked = check_prefix(prefix); !checked) return checked.error();
  KeyWalk walk(calls_, objects_, after, limit);
  if (auto added = walk.add(std::string(prefix)); !added) return added.error();
  std::vector<BlobKey> keys;
  keys.reserve(walk.blobs().size());
  for (BlobInfo& blob : walk.blobs()) keys.push_back(std::move(blob.key));
  return keys;
}

Result<std::vector<BlobInfo>> DirStore::inventory(std::string_view prefix) const {
  if (auto checked = check_prefix(prefix); !checked) return checked.error();
  KeyWalk walk(calls_, objects_, "", std::numeric_limits<std::size_t>::max());
  if (auto added = walk.add(std::string(prefix)); !added) return std::move(added).error();
  return std::move(walk.blobs());
}

void DirStore::touch(const BlobKey& key) {
  if (check_key(key)) calls_.utimens_now((objects_ / key).c_str());
}

Result<std::vector<std::string>> DirStore::children(std::string_view prefix) const {
  if (auto checked = check_prefix(prefix); !checked) return checked.error();
  const auto entries = key_entries(calls_, objects_ / prefix);
  if (!entries) return entries.error();
  std::vector<std::string> names;
  for (const auto& entry : *entries) {
    if (entry.is_folder) {  // a process that was killed may have left one without any blob
      const auto first = list(std::string(prefix) + entry.name + "/", "", 1);
      if (!first) return first.error();
      if (first->empty()) continue;
    }
    names.push_back(entry.name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

// Flushes also when nothing was there: an earlier removal may have failed at exactly that.
Result<void> DirStore::remove(const BlobKey& key) {
  if (auto checked = check_key(key); !checked) return checked;
  const auto turn = locks_.take(key);
  if (!turn) return turn.error();
  const fs::path path = objects_ / key;
  if (calls_.unlink(path.c_str()) != 0 && errno != ENOENT && errno != ENOTDIR && errno != EISDIR)
    return file_error(path, "cannot remove", errno);
  return folders_.flush(folders_.remove_empty(path.parent_path()));
}

// Folders on the way may belong to others and be closed to us, so only where one is made its entry is flushed.
Result<void> make_durable_folder(FileCalls& calls, const fs::path& folder) {
  struct stat status {};
  if (calls.stat(folder.c_str(), &status) == 0 && S_ISDIR(status.st_mode)) return {};
  const fs::path parent = folder.parent_path();
  if (parent == folder) return file_error(folder, "cannot open this folder", errno);
  if (auto made = make_durable_folder(calls, parent); !made) return made;
  FolderTree above(calls, parent);
  if (auto made = above.make(folder); !made) return made;
  return above.flush(parent);
}

}  // namespace

Result<std::unique_ptr<BlobStore>> open_dir_store(const fs::path& root, FileCalls& calls) {
  std::error_code problem;
  fs::path absolute = fs::absolute(root, problem).lexically_normal();
  if (problem) return file_error(root, "cannot open this folder", problem.value());
  if (!absolute.has_filename()) absolute = absolute.parent_path();  // "store/"
  for (const char* name : {"objects", "staging", "locks"})
    if (auto made = make_durable_folder(calls, absolute / name); !made) return made.error();
  auto staging = StagingArea::open(calls, absolute / "staging");
  if (!staging) return std::move(staging).error();
  return std::unique_ptr<BlobStore>(std::make_unique<DirStore>(calls, absolute, *std::move(staging)));
}

}  // namespace geosis::server
