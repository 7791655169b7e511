#include "engine/volume/mapped_file.h"

#include <cerrno>
#include <cstdlib>
#include <limits>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace geosis {
namespace {

Error failed(const std::string& what, const std::filesystem::path& where, int number) {
  const bool full = number == ENOSPC || number == EDQUOT || number == EFBIG;
  const ErrorCode code = full ? ErrorCode::no_space : number == ENOENT ? ErrorCode::not_found : ErrorCode::unavailable;
  return {code, what + " " + where.string() + ": " + std::generic_category().message(number)};
}

int open_unnamed(const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (descriptor >= 0) return descriptor;
  // Not every file system has O_TMPFILE.
  std::string name = (folder / "geosis-XXXXXX").string();
  const int named = ::mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) ::unlink(name.c_str());
  return named;
}

}  // namespace

Result<std::unique_ptr<MappedFile>> MappedFile::open(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return failed("cannot open", path, errno);
  std::unique_ptr<MappedFile> file(new MappedFile(descriptor));
  struct stat status = {};
  if (::fstat(descriptor, &status) != 0) return failed("cannot read the size of", path, errno);
  if (!S_ISREG(status.st_mode)) return Error{ErrorCode::malformed_input, path.string() + " is not a regular file"};
  if (status.st_size == 0) return Error{ErrorCode::malformed_input, path.string() + " is empty"};
  if (auto mapped = file->map(static_cast<std::uint64_t>(status.st_size), false, path); !mapped) return mapped.error();
  return file;
}

Result<std::unique_ptr<MappedFile>> MappedFile::create(const std::filesystem::path& path, std::uint64_t bytes) {
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (descriptor < 0) return failed("cannot create", path, errno);
  std::unique_ptr<MappedFile> file(new MappedFile(descriptor));
  auto ready = file->reserve(bytes, path);
  if (ready) ready = file->map(bytes, true, path);
  if (ready) return file;
  ::unlink(path.c_str());
  return std::move(ready).error();
}

Result<std::unique_ptr<MappedFile>> MappedFile::create_unnamed(std::uint64_t bytes) {
  std::error_code no_folder;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(no_folder);
  if (no_folder) return Error{ErrorCode::unavailable, "no folder for temporary files: " + no_folder.message()};
  return create_unnamed(bytes, folder);
}

Result<std::unique_ptr<MappedFile>> MappedFile::create_unnamed(std::uint64_t bytes,
                                                               const std::filesystem::path& folder) {
  const int descriptor = open_unnamed(folder);
  if (descriptor < 0) return failed("cannot create a temporary file in", folder, errno);
  std::unique_ptr<MappedFile> file(new MappedFile(descriptor));
  if (auto reserved = file->reserve(bytes, folder); !reserved) return reserved.error();
  if (auto mapped = file->map(bytes, true, folder); !mapped) return mapped.error();
  return file;
}

MappedFile::~MappedFile() {
  if (data_) ::munmap(data_, size_);
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<void> MappedFile::reserve(std::uint64_t bytes, const std::filesystem::path& where) const {
  const std::string what = "cannot reserve " + std::to_string(bytes) + " bytes in";
  if (bytes > static_cast<std::uint64_t>(std::numeric_limits<off_t>::max())) return failed(what, where, EFBIG);
  const int number = ::posix_fallocate(descriptor_, 0, static_cast<off_t>(bytes));
  if (number != 0) return failed(what, where, number);
  return {};
}

Result<void> MappedFile::map(std::uint64_t bytes, bool writable, const std::filesystem::path& where) {
  const int protection = writable ? PROT_READ | PROT_WRITE : PROT_READ;
  void* data = ::mmap(nullptr, bytes, protection, MAP_SHARED, descriptor_, 0);
  if (data == MAP_FAILED) return failed("cannot map", where, errno);
  data_ = static_cast<std::byte*>(data);
  size_ = bytes;
  return {};
}

Result<void> MappedFile::write_at(std::uint64_t offset, std::span<const std::byte> bytes) const {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return failed("cannot write", "a new file", errno);
    offset += static_cast<std::uint64_t>(written);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return {};
}

// Advice: where it fails or is not known, sync() has more to do.
void MappedFile::start_writing(std::uint64_t offset, std::uint64_t bytes) const {
  ::sync_file_range(descriptor_, static_cast<off_t>(offset), static_cast<off_t>(bytes), SYNC_FILE_RANGE_WRITE);
}

Result<void> MappedFile::sync() const {
  if (::fsync(descriptor_) != 0)
    return Error{ErrorCode::unavailable, "cannot write a file to the disk: " + std::generic_category().message(errno)};
  return {};
}

Result<void> sync_folder(const std::filesystem::path& folder) {
  const std::filesystem::path name = folder.empty() ? "." : folder;
  const int descriptor = ::open(name.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return failed("cannot open", name, errno);
  const int synced = ::fsync(descriptor);
  const int number = errno;
  ::close(descriptor);
  if (synced != 0) return failed("cannot write to the disk", name, number);
  return {};
}

}  // namespace geosis
