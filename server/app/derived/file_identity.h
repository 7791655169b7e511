#pragma once

#include <cstdint>
#include <filesystem>
#include <system_error>

namespace geosis::server {

/// What tells whether a file is still the one that was looked at: a file that somebody writes to is another one.
struct FileIdentity {
  std::uintmax_t bytes = 0;
  std::filesystem::file_time_type modified{};

  bool operator==(const FileIdentity&) const = default;
};

/// Of a file that is gone: unlike any other.
inline FileIdentity identity_of(const std::filesystem::path& path) {
  std::error_code gone;
  const auto bytes = std::filesystem::file_size(path, gone);
  const auto modified = gone ? std::filesystem::file_time_type{} : std::filesystem::last_write_time(path, gone);
  return gone ? FileIdentity{} : FileIdentity{bytes, modified};
}

}  // namespace geosis::server
