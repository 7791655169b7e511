#include "engine/volume/formats/byte_source.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace geosis {
namespace {

Result<void> check_within(std::uint64_t offset, std::size_t bytes, std::uint64_t size) {
  if (offset <= size && bytes <= size - offset) return {};
  return Error{ErrorCode::malformed_input, "file cut short: " + std::to_string(bytes) + " bytes needed at offset " +
                                               std::to_string(offset) + " of " + std::to_string(size)};
}

class File final : public ByteSource {
 public:
  explicit File(int descriptor) : descriptor_(descriptor) {}
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() override { ::close(descriptor_); }

  void set_size(std::uint64_t size) { size_ = size; }
  std::uint64_t size() const override { return size_; }

  Result<void> read_at(std::uint64_t offset, std::span<std::byte> into) const override {
    if (auto within = check_within(offset, into.size(), size_); !within) return within;
    while (!into.empty()) {
      const ssize_t got = ::pread(descriptor_, into.data(), into.size(), static_cast<off_t>(offset));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0)
        return Error{ErrorCode::unavailable, "reading failed at offset " + std::to_string(offset) + ": " +
                                                 std::generic_category().message(errno)};
      if (got == 0)
        return Error{ErrorCode::malformed_input, "the file became shorter: nothing left at " + std::to_string(offset)};
      into = into.subspan(static_cast<std::size_t>(got));
      offset += static_cast<std::uint64_t>(got);
    }
    return {};
  }

 private:
  int descriptor_;
  std::uint64_t size_ = 0;
};

class Memory final : public ByteSource {
 public:
  explicit Memory(std::span<const std::byte> bytes) : bytes_(bytes) {}

  std::uint64_t size() const override { return bytes_.size(); }

  Result<void> read_at(std::uint64_t offset, std::span<std::byte> into) const override {
    if (auto within = check_within(offset, into.size(), bytes_.size()); !within) return within;
    const auto piece = bytes_.subspan(static_cast<std::size_t>(offset), into.size());
    std::copy(piece.begin(), piece.end(), into.begin());
    return {};
  }

 private:
  std::span<const std::byte> bytes_;
};

}  // namespace

Result<std::unique_ptr<ByteSource>> open_file(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) {
    const ErrorCode code = errno == ENOENT || errno == ENOTDIR ? ErrorCode::not_found : ErrorCode::unavailable;
    return Error{code, "cannot open " + path.string() + ": " + std::generic_category().message(errno)};
  }
  auto file = std::make_unique<File>(descriptor);
  struct stat status = {};
  if (::fstat(descriptor, &status) != 0)
    return Error{ErrorCode::unavailable,
                 "cannot read the size of " + path.string() + ": " + std::generic_category().message(errno)};
  if (!S_ISREG(status.st_mode)) return Error{ErrorCode::invalid_argument, path.string() + " is not a regular file"};
  file->set_size(static_cast<std::uint64_t>(status.st_size));
  return std::unique_ptr<ByteSource>(std::move(file));
}

std::unique_ptr<ByteSource> memory_source(std::span<const std::byte> bytes) {
  return std::make_unique<Memory>(bytes);
}

}  // namespace geosis
