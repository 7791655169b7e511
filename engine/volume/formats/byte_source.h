#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "engine/base/result.h"

namespace geosis {

/// Bytes of a file that readers take pieces from. Implementations may be read by several threads.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  virtual std::uint64_t size() const = 0;
  /// Fills all of `into` from `offset`. errors: malformed_input (past the end), unavailable (reading failed).
  virtual Result<void> read_at(std::uint64_t offset, std::span<std::byte> into) const = 0;
};

/// errors: not_found, unavailable; invalid_argument: not a regular file.
Result<std::unique_ptr<ByteSource>> open_file(const std::filesystem::path& path);
/// The bytes must outlive the source.
std::unique_ptr<ByteSource> memory_source(std::span<const std::byte> bytes);

}  // namespace geosis
