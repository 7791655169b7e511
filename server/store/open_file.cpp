#include "server/store/open_file.h"

#include <cerrno>
#include <string>
#include <system_error>

namespace geosis::server {

Error file_error(const std::filesystem::path& path, const char* what, int number) {
  const bool is_full = number == ENOSPC || number == EDQUOT;
  return {is_full ? ErrorCode::no_space : ErrorCode::unavailable,
          path.string() + ": " + what + ": " + std::generic_category().message(number)};
}

int OpenFile::write_all(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = calls_->write(descriptor_, bytes.data(), bytes.size());
    if (count < 0) return -1;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return 0;
}

int OpenFile::read_all(std::span<std::byte> bytes, std::uint64_t offset) {
  while (!bytes.empty()) {
    const ssize_t count = calls_->pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (count == 0) errno = EIO;  // shorter than its size said
    if (count <= 0) return -1;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
    offset += static_cast<std::uint64_t>(count);
  }
  return 0;
}

}  // namespace geosis::server
