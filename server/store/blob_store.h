#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
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

/// Immutable blobs by name: what a restart must remember. Any thread, any number of processes on one store.
///
/// put and commit are atomic and durable: when they return, the blob survives a crash, and no reader ever sees a part
/// of it. Putting a name again replaces it (with equal bytes, as names are made of content).
class BlobStore {
 public:
  virtual ~BlobStore() = default;

  /// errors   invalid_argument: not a key, or a folder of others.  no_space.  unavailable: the store failed.
  virtual Result<void> put(const BlobKey& key, std::span<const std::byte> bytes) = 0;
  /// The whole blob, its checksum verified. For documents and parts (up to some MB).
  ///
  /// errors   not_found.  malformed_input: damaged.  unavailable.
  virtual Result<std::vector<std::byte>> get(const BlobKey& key) const = 0;
  virtual Result<bool> exists(const BlobKey& key) const = 0;
  /// Keys that start with `prefix` (which ends with "/", or is empty), sorted; at most `limit`, those after `after`.
  virtual Result<std::vector<BlobKey>> list(std::string_view prefix, std::string_view after,
                                            std::size_t limit) const = 0;
  /// Names directly below `prefix` (which ends with "/"): files, and folders with a blob somewhere below, sorted.
  virtual Result<std::vector<std::string>> children(std::string_view prefix) const = 0;
  /// Durable, too. Removing what is not there succeeds.
  virtual Result<void> remove(const BlobKey& key) = 0;

  /// For big files that are written in place (uploads, bricks). A writer may replace the empty file at its path.
  /// errors: no_space, unavailable.
  virtual Result<std::unique_ptr<StagedFile>> stage() = 0;
  /// fsync, rename, fsync of the folder. The file carries checksums of its own (bricks); get() does not read it and
  /// calls it malformed_input. errors: as put; the file is gone in any case.
  virtual Result<void> commit(std::unique_ptr<StagedFile> file, const BlobKey& key) = 0;
  /// Local file behind a committed key (not one that was put), to be mapped read-only. errors: not_found.
  virtual Result<std::filesystem::path> local_file(const BlobKey& key) const = 0;
};

}  // namespace geosis::server
