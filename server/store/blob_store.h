#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/base/result.h"

namespace geosis::server {

/// Name of a blob: segments of [A-Za-z0-9._-] joined by "/", none of them "." or "..", at most 512 bytes; the first
/// segment is the tenant. A segment has at most 255 bytes, and no key is a folder of others ("a" beside "a/b").
/// Example: "default/volumes/3f…/volume.json".
using BlobKey = std::string;

/// A file being made inside the store, invisible until it is committed. Destroyed uncommitted, it vanishes; after a
/// crash the next start removes it.
class StagedFile {
 public:
  virtual ~StagedFile() = default;
  virtual const std::filesystem::path& path() const = 0;
};

/// The bytes of a blob, and what tells them from any other bytes it may have later (an ETag).
struct VersionedBlob {
  std::vector<std::byte> bytes;
  std::string version;
};

struct BlobInfo {
  BlobKey key;
  std::uint64_t bytes = 0;                     ///< that it takes in the store
  std::chrono::system_clock::time_point used;  ///< when it was last written or touched
};

/// Blobs by name: what a restart must remember. Any thread, any number of processes on one store.
///
/// put, put_if and commit are atomic and durable: when they return, the blob survives a crash, and no reader ever sees
/// a part of it. Most blobs are immutable: putting their name again replaces them with equal bytes. The few that change
/// (sidecars, run records) are changed with put_if alone, so that no process undoes what another did. Nothing here asks
/// for more than an object store has: conditional put, copy onto itself for touch(), times of last change.
class BlobStore {
 public:
  virtual ~BlobStore() = default;

  /// errors   invalid_argument: not a key, or a folder of others.  no_space.  unavailable: the store failed.
  virtual Result<void> put(const BlobKey& key, std::span<const std::byte> bytes) = 0;
  /// The whole blob, its checksum verified. For documents and parts (up to some MB).
  ///
  /// errors   not_found.  internal: damaged.  unavailable.
  virtual Result<std::vector<std::byte>> get(const BlobKey& key) const = 0;
  /// The same with its version, for put_if.
  virtual Result<VersionedBlob> get_versioned(const BlobKey& key) const = 0;
  /// Puts if the blob has still this version; "" = if it is not there.
  ///
  /// returns  false: it has another one, and nothing was changed.  errors: as put; internal: what is there is damaged.
  virtual Result<bool> put_if(const BlobKey& key, std::span<const std::byte> bytes, const std::string& version) = 0;
  virtual Result<bool> exists(const BlobKey& key) const = 0;
  /// Keys that start with `prefix` (which ends with "/", or is empty), sorted; at most `limit`, those after `after`.
  virtual Result<std::vector<BlobKey>> list(std::string_view prefix, std::string_view after,
                                            std::size_t limit) const = 0;
  /// All blobs below `prefix` with their sizes and times, in the order of keys.
  virtual Result<std::vector<BlobInfo>> inventory(std::string_view prefix) const = 0;
  /// Says that a blob was used just now, if it is there. Not durable, and nobody waits for it.
  virtual void touch(const BlobKey& key) = 0;
  /// Names directly below `prefix` (which ends with "/"): files, and folders with a blob somewhere below, sorted.
  virtual Result<std::vector<std::string>> children(std::string_view prefix) const = 0;
  /// Durable, too. Removing what is not there succeeds.
  virtual Result<void> remove(const BlobKey& key) = 0;

  /// For big files that are written in place (uploads, bricks). A writer may replace the empty file at its path.
  /// errors: no_space, unavailable.
  virtual Result<std::unique_ptr<StagedFile>> stage() = 0;
  /// fsync, rename, fsync of the folder. The file carries checksums of its own (bricks); get() does not read it and
  /// calls it damaged. errors: as put; the file is gone in any case.
  virtual Result<void> commit(std::unique_ptr<StagedFile> file, const BlobKey& key) = 0;
  /// Local file behind a committed key (not one that was put), to be mapped read-only. errors: not_found.
  virtual Result<std::filesystem::path> local_file(const BlobKey& key) const = 0;

  /// A name for this process that no other one on this store has or had, of key characters.
  virtual std::string process_name() const = 0;
  /// False only when the process of that name has certainly ended; true where the store cannot tell.
  virtual bool may_be_running(const std::string& process) const = 0;

  /// Called with every damage that is found, from any thread; set before the store is used. A store that finds one
  /// reports it by itself; files that carry checksums of their own are reported by whoever reads them.
  using DamageListener = std::function<void(const BlobKey& key, const std::string& why)>;
  void on_damage(DamageListener listener) { listener_ = std::move(listener); }
  void report_damage(const BlobKey& key, const std::string& why) const {
    if (listener_) listener_(key, why);
  }

 private:
  DamageListener listener_;
};

/// Removes what is directly below `folder` (which ends with "/"). errors: those of the store; then some may be left.
inline Result<void> remove_children(BlobStore& store, const BlobKey& folder) {
  const auto names = store.children(folder);
  if (!names) return names.error();
  for (const std::string& name : *names) {
    if (auto done = store.remove(folder + name); !done) return done;
  }
  return {};
}

}  // namespace geosis::server
