#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>

#include "engine/base/result.h"
#include "engine/volume/mapped_file.h"

namespace geosis {

/// A file that appears under its name only when it is complete: it grows as `<name>.<process>-<serial>.part` beside it.
/// One that is destroyed without publish() leaves nothing behind.
class NewFile {
 public:
  /// Reserves the whole file, zeros. path: its name at the end, replacing what is there; std::nullopt = an unnamed
  /// temporary file. errors: no_space, unavailable.
  static Result<NewFile> create(const std::optional<std::filesystem::path>& path, std::uint64_t bytes);

  NewFile(NewFile&&) noexcept = default;
  NewFile& operator=(NewFile&&) = delete;
  ~NewFile();

  std::span<std::byte> writable() { return file_->writable(); }
  /// See MappedFile.
  Result<void> write_at(std::uint64_t offset, std::span<const std::byte> bytes) const {
    return file_->write_at(offset, bytes);
  }
  const MappedFile& file() const { return *file_; }
  /// Flushes the file, gives it its name and flushes the folder; nothing of this for an unnamed one.
  /// errors: unavailable.
  Result<std::unique_ptr<MappedFile>> publish() &&;

 private:
  explicit NewFile(std::unique_ptr<MappedFile> file) : file_(std::move(file)) {}

  std::unique_ptr<MappedFile> file_;
  std::filesystem::path path_, unfinished_;  ///< both empty for an unnamed file
};

}  // namespace geosis
