#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "server/store/blob_store.h"

namespace geosis::server {

/// A store that stays within a size: before something big is stored, the derived results that were used longest ago
/// are removed until there is room, by whatever tenant: parts, levels and bodies of an extraction, whose request stays,
/// so that it is computed again when somebody asks; and filled samples. Volumes are never removed: when only they are
/// left, storing fails with no_space.
///
/// What was used in the last minute stays, so that who reads a result part by part comes to its end; an open file stays
/// readable in any case. Several servers with the same limit may share a store: each looks at what the others stored
/// before it stores, at most every few seconds.
class LimitedStore final : public BlobStore {
 public:
  struct Options {
    std::uint64_t limit = 0;  ///< bytes of all blobs; 0 = no limit
    std::chrono::milliseconds grace = std::chrono::seconds(60);
    std::chrono::milliseconds freshness = std::chrono::seconds(5);  ///< how old what is known of the store may be
  };
  LimitedStore(std::unique_ptr<BlobStore> store, Options options);

  Result<void> put(const BlobKey& key, std::span<const std::byte> bytes) override;
  Result<void> commit(std::unique_ptr<StagedFile> file, const BlobKey& key) override;
  /// At most every few seconds for each blob, and without a limit not at all.
  void touch(const BlobKey& key) override;

  Result<std::vector<std::byte>> get(const BlobKey& key) const override { return store_->get(key); }
  Result<VersionedBlob> get_versioned(const BlobKey& key) const override { return store_->get_versioned(key); }
  Result<bool> put_if(const BlobKey& key, std::span<const std::byte> bytes, const std::string& version) override {
    return store_->put_if(key, bytes, version);
  }
  Result<bool> exists(const BlobKey& key) const override { return store_->exists(key); }
  Result<std::vector<BlobKey>> list(std::string_view prefix, std::string_view after, std::size_t limit) const override {
    return store_->list(prefix, after, limit);
  }
  Result<std::vector<BlobInfo>> inventory(std::string_view prefix) const override { return store_->inventory(prefix); }
  Result<std::vector<std::string>> children(std::string_view prefix) const override { return store_->children(prefix); }
  Result<void> remove(const BlobKey& key) override { return store_->remove(key); }
  Result<std::unique_ptr<StagedFile>> stage() override { return store_->stage(); }
  Result<std::filesystem::path> local_file(const BlobKey& key) const override { return store_->local_file(key); }
  std::string process_name() const override { return store_->process_name(); }
  bool may_be_running(const std::string& process) const override { return store_->may_be_running(process); }

 private:
  Result<void> make_room(std::uint64_t bytes);
  Result<void> evict_down_to(std::uint64_t most);

  const std::unique_ptr<BlobStore> store_;
  const Options options_;
  std::mutex mutex_;          ///< of what follows; held while room is made
  std::uint64_t stored_ = 0;  ///< as last seen, and what was stored here since then
  std::chrono::steady_clock::time_point seen_{};
  std::mutex touching_;
  std::map<BlobKey, std::chrono::steady_clock::time_point> touched_;
};

}  // namespace geosis::server
