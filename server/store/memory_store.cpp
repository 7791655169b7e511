#include "server/store/memory_store.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <map>
#include <mutex>
#include <system_error>
#include <utility>

#include "server/store/blob_key.h"
#include "server/store/file_calls.h"
#include "server/store/staging_area.h"

namespace geosis::server {
namespace {

namespace fs = std::filesystem;

class TemporaryFolder {
 public:
  explicit TemporaryFolder(fs::path path) : path_(std::move(path)) {}
  TemporaryFolder(TemporaryFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  TemporaryFolder& operator=(TemporaryFolder&&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

// Either bytes in memory or a committed file, which stays under its staged name or not at all.
struct StoredBlob {
  std::vector<std::byte> bytes;
  std::shared_ptr<const StagedFile> file;
  std::uint64_t change = 0;  // of all changes of the store, the one that made it
  std::chrono::system_clock::time_point used{};
};

class MemoryStore final : public BlobStore {
 public:
  MemoryStore(TemporaryFolder folder, std::unique_ptr<StagingArea> staging)
      : folder_(std::move(folder)), staging_(std::move(staging)) {}

  Result<void> put(const BlobKey& key, std::span<const std::byte> bytes) override {
    const std::lock_guard lock(mutex_);
    return insert(key, {.bytes = {bytes.begin(), bytes.end()}, .file = nullptr});
  }
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
  Result<void> insert(const BlobKey& key, StoredBlob blob);
  bool collides(const BlobKey& key) const;
  Result<StoredBlob> find(const BlobKey& key) const;

  TemporaryFolder folder_;
  std::unique_ptr<StagingArea> staging_;
  mutable std::mutex mutex_;
  std::uint64_t changes_ = 0;
  std::map<BlobKey, StoredBlob, std::less<>> blobs_;
};

Result<void> MemoryStore::insert(const BlobKey& key, StoredBlob blob) {
  if (auto checked = check_key(key); !checked) return checked;
  if (collides(key)) return Error{ErrorCode::invalid_argument, key + ": a blob's name cannot be a folder of others"};
  blob.change = ++changes_;
  blob.used = std::chrono::system_clock::now();
  blobs_.insert_or_assign(key, std::move(blob));
  return {};
}

bool MemoryStore::collides(const BlobKey& key) const {
  for (std::size_t slash = key.find('/'); slash != BlobKey::npos; slash = key.find('/', slash + 1))
    if (blobs_.contains(key.substr(0, slash))) return true;
  const auto below = blobs_.lower_bound(key + "/");
  return below != blobs_.end() && below->first.starts_with(key + "/");
}

Result<void> MemoryStore::commit(std::unique_ptr<StagedFile> file, const BlobKey& key) {
  if (!file || !staging_->owns(*file))
    return Error{ErrorCode::invalid_argument, "the file for \"" + key + "\" was not staged in this store"};
  const std::lock_guard lock(mutex_);
  return insert(key, {.bytes = {}, .file = std::move(file)});
}

Result<StoredBlob> MemoryStore::find(const BlobKey& key) const {
  if (auto checked = check_key(key); !checked) return checked.error();
  const std::lock_guard lock(mutex_);
  const auto found = blobs_.find(key);
  if (found == blobs_.end()) return Error{ErrorCode::not_found, "no blob \"" + key + "\""};
  return found->second;
}

Result<std::vector<std::byte>> MemoryStore::get(const BlobKey& key) const {
  auto blob = find(key);
  if (!blob) return std::move(blob).error();
  if (blob->file) return Error{ErrorCode::internal, "blob \"" + key + "\" is a committed file"};
  return std::move(blob->bytes);
}

Result<VersionedBlob> MemoryStore::get_versioned(const BlobKey& key) const {
  auto blob = find(key);
  if (!blob) return std::move(blob).error();
  return VersionedBlob{std::move(blob->bytes), std::to_string(blob->change)};
}

Result<bool> MemoryStore::put_if(const BlobKey& key, std::span<const std::byte> bytes, const std::string& version) {
  const std::lock_guard lock(mutex_);
  const auto found = blobs_.find(key);
  if ((found == blobs_.end() ? "" : std::to_string(found->second.change)) != version) return false;
  if (auto done = insert(key, {.bytes = {bytes.begin(), bytes.end()}, .file = nullptr}); !done)
    return std::move(done).error();
  return true;
}

Result<fs::path> MemoryStore::local_file(const BlobKey& key) const {
  const auto blob = find(key);
  if (!blob) return blob.error();
  if (!blob->file) return Error{ErrorCode::not_found, "no file behind blob \"" + key + "\""};
  return blob->file->path();
}

Result<bool> MemoryStore::exists(const BlobKey& key) const {
  if (auto checked = check_key(key); !checked) return checked.error();
  const std::lock_guard lock(mutex_);
  return blobs_.contains(key);
}

Result<std::vector<BlobKey>> MemoryStore::list(std::string_view prefix, std::string_view after,
                                               std::size_t limit) const {
  if (auto checked = check_prefix(prefix); !checked) return checked.error();
  const std::lock_guard lock(mutex_);
  std::vector<BlobKey> keys;
  auto at = after < prefix ? blobs_.lower_bound(prefix) : blobs_.upper_bound(after);
  for (; at != blobs_.end() && at->first.starts_with(prefix) && keys.size() < limit; ++at) keys.push_back(at->first);
  return keys;
}

Result<std::vector<BlobInfo>> MemoryStore::inventory(std::string_view prefix) const {
  if (auto checked = check_prefix(prefix); !checked) return checked.error();
  const std::lock_guard lock(mutex_);
  std::vector<BlobInfo> blobs;
  for (auto at = blobs_.lower_bound(prefix); at != blobs_.end() && at->first.starts_with(prefix); ++at) {
    std::error_code gone;
    const auto& [key, blob] = *at;
    blobs.push_back({key, blob.file ? fs::file_size(blob.file->path(), gone) : blob.bytes.size(), blob.used});
  }
  return blobs;
}

void MemoryStore::touch(const BlobKey& key) {
  const std::lock_guard lock(mutex_);
  const auto found = blobs_.find(key);
  if (found != blobs_.end()) found->second.used = std::chrono::system_clock::now();
}

Result<std::vector<std::string>> MemoryStore::children(std::string_view prefix) const {
  if (auto checked = check_prefix(prefix); !checked) return checked.error();
  const std::lock_guard lock(mutex_);
  std::vector<std::string> names;
  for (auto at = blobs_.lower_bound(prefix); at != blobs_.end() && at->first.starts_with(prefix); ++at) {
    const std::string rest = at->first.substr(prefix.size());
    const std::string name = rest.substr(0, rest.find('/'));
    if (names.empty() || names.back() != name) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

Result<void> MemoryStore::remove(const BlobKey& key) {
  if (auto checked = check_key(key); !checked) return checked;
  const std::lock_guard lock(mutex_);
  blobs_.erase(key);
  return {};
}

}  // namespace

Result<std::unique_ptr<BlobStore>> open_memory_store() {
  std::error_code problem;
  std::string pattern = (fs::temp_directory_path(problem) / "geosis-XXXXXX").string();
  if (problem || !system_file_calls().mkdtemp(pattern.data()))
    return file_error(pattern, "cannot make this folder", problem ? problem.value() : errno);
  TemporaryFolder folder(pattern);
  auto staging = StagingArea::open(system_file_calls(), folder.path());
  if (!staging) return std::move(staging).error();
  return std::unique_ptr<BlobStore>(std::make_unique<MemoryStore>(std::move(folder), *std::move(staging)));
}

}  // namespace geosis::server
