#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "engine/base/result.h"
#include "server/store/blob_store.h"
#include "server/store/open_file.h"

namespace geosis::server {

/// A file that arrives piece by piece, written into the store's staging: memory stays flat whatever its size.
class Spool {
 public:
  /// bytes   that its sender has announced: a file that cannot fit is not even begun.
  ///
  /// errors  no_space.  unavailable: the staging cannot be written.
  static Result<Spool> open(BlobStore& store, std::optional<std::uint64_t> bytes);
  /// errors: no_space, unavailable.
  Result<void> write(std::span<const std::byte> bytes);
  /// The file as it is now; nothing may be written after that.
  std::unique_ptr<StagedFile> take();

 private:
  Spool(std::unique_ptr<StagedFile> staged, OpenFile file) : staged_(std::move(staged)), file_(std::move(file)) {}

  std::unique_ptr<StagedFile> staged_;
  OpenFile file_;
};

}  // namespace geosis::server
