#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "engine/base/result.h"

namespace geosis {

/// A whole file in memory by mmap; unmapped and closed with the object.
class MappedFile {
 public:
  /// Read-only. errors: not_found, unavailable; malformed_input: empty or not a regular file.
  static Result<std::unique_ptr<MappedFile>> open(const std::filesystem::path& path);
  /// A new file of `bytes` zeros at `path`, which must not exist yet, readable and writable. The space is reserved, so
  /// that no later write through the mapping can fail. errors: no_space, unavailable.
  static Result<std::unique_ptr<MappedFile>> create(const std::filesystem::path& path, std::uint64_t bytes);
  /// The same without a name, in the system's folder for temporary files.
  static Result<std::unique_ptr<MappedFile>> create_unnamed(std::uint64_t bytes);
  /// The same in a folder of choice.
  static Result<std::unique_ptr<MappedFile>> create_unnamed(std::uint64_t bytes, const std::filesystem::path& folder);

  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  ~MappedFile();

  std::span<const std::byte> bytes() const { return {data_, size_}; }
  std::span<std::byte> writable() { return {data_, size_}; }
  /// Writes through the file instead of the mapping, which shows the same bytes: new pages are then neither zeroed nor
  /// brought in one by one. errors: unavailable, no_space.
  Result<void> write_at(std::uint64_t offset, std::span<const std::byte> bytes) const;
  /// Begins to write these bytes to the disk and does not wait for it; sync() tells whether that came to a good end.
  void start_writing(std::uint64_t offset, std::uint64_t bytes) const;
  /// Returns when all bytes are on the disk. errors: unavailable.
  Result<void> sync() const;

 private:
  explicit MappedFile(int descriptor) : descriptor_(descriptor) {}
  Result<void> reserve(std::uint64_t bytes, const std::filesystem::path& where) const;
  Result<void> map(std::uint64_t bytes, bool writable, const std::filesystem::path& where);

  int descriptor_ = -1;
  std::byte* data_ = nullptr;
  std::size_t size_ = 0;
};

/// Makes a rename in this folder durable. errors: unavailable.
Result<void> sync_folder(const std::filesystem::path& folder);

}  // namespace geosis
