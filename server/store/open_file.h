#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <utility>

#include "engine/base/result.h"
#include "server/store/file_calls.h"

namespace geosis::server {

/// A failed system call as an error that names the path, what was tried, and the reason.
/// returns  no_space when the disk or the quota is full, else unavailable.
Error file_error(const std::filesystem::path& path, const char* what, int number);

/// A descriptor that closes itself.
class OpenFile {
 public:
  OpenFile(FileCalls& calls, int descriptor) : calls_(&calls), descriptor_(descriptor) {}
  OpenFile(OpenFile&& other) noexcept : calls_(other.calls_), descriptor_(std::exchange(other.descriptor_, -1)) {}
  OpenFile& operator=(OpenFile&&) = delete;
  ~OpenFile() { close(); }

  bool is_open() const { return descriptor_ >= 0; }
  int descriptor() const { return descriptor_; }
  /// -1 and errno on failure; the descriptor is gone in any case.
  int close() { return is_open() ? calls_->close(std::exchange(descriptor_, -1)) : 0; }

  /// -1 and errno on failure, also when the file ends early.
  int write_all(std::span<const std::byte> bytes);
  int read_all(std::span<std::byte> bytes, std::uint64_t offset);

 private:
  FileCalls* calls_;
  int descriptor_;
};

}  // namespace geosis::server
