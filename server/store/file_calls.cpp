#include "server/store/file_calls.h"

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string_view>

#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace geosis::server {
namespace {

template <class Call>
auto until_not_interrupted(Call call) {
  auto result = call();
  while (result == -1 && errno == EINTR) result = call();
  return result;
}

std::chrono::system_clock::time_point time_of(const timespec& time) {
  const auto since_epoch = std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
  return std::chrono::system_clock::time_point(
      std::chrono::duration_cast<std::chrono::system_clock::duration>(since_epoch));
}

struct CloseFolder {
  void operator()(DIR* folder) const { closedir(folder); }
};

}  // namespace

int FileCalls::open(const char* path, int flags, mode_t mode) {
  return until_not_interrupted([&] { return ::open(path, flags | O_CLOEXEC, mode); });
}

// Not made again when interrupted: Linux has closed the descriptor then.
int FileCalls::close(int descriptor) {
  return ::close(descriptor);
}

ssize_t FileCalls::write(int descriptor, const void* bytes, std::size_t count) {
  return until_not_interrupted([&] { return ::write(descriptor, bytes, count); });
}

ssize_t FileCalls::pread(int descriptor, void* bytes, std::size_t count, off_t offset) {
  return until_not_interrupted([&] { return ::pread(descriptor, bytes, count, offset); });
}

int FileCalls::fsync(int descriptor) {
  return until_not_interrupted([&] { return ::fsync(descriptor); });
}

int FileCalls::flock(int descriptor, int operation) {
  return until_not_interrupted([&] { return ::flock(descriptor, operation); });
}

int FileCalls::fstat(int descriptor, struct stat* status) {
  return ::fstat(descriptor, status);
}

int FileCalls::stat(const char* path, struct stat* status) {
  return ::stat(path, status);
}

int FileCalls::lstat(const char* path, struct stat* status) {
  return ::lstat(path, status);
}

int FileCalls::statx(int descriptor, unsigned int mask, struct statx* status) {
  return ::statx(descriptor, "", AT_EMPTY_PATH, mask, status);
}

int FileCalls::utimens_now(const char* path) {
  return ::utimensat(AT_FDCWD, path, nullptr, AT_SYMLINK_NOFOLLOW);
}

int FileCalls::rename(const char* from, const char* to) {
  return ::rename(from, to);
}

int FileCalls::unlink(const char* path) {
  return ::unlink(path);
}

int FileCalls::mkdir(const char* path, mode_t mode) {
  return ::mkdir(path, mode);
}

int FileCalls::rmdir(const char* path) {
  return ::rmdir(path);
}

char* FileCalls::mkdtemp(char* pattern) {
  return ::mkdtemp(pattern);
}

int FileCalls::list_folder(const char* path, std::vector<FolderEntry>& entries) {
  const std::unique_ptr<DIR, CloseFolder> folder(::opendir(path));
  if (!folder) return -1;
  while (true) {
    errno = 0;
    const dirent* entry = ::readdir(folder.get());  // NOLINT(concurrency-mt-unsafe): the stream is this call's own
    if (!entry) return errno == 0 ? 0 : -1;
    const std::string_view name = entry->d_name;
    if (name == "." || name == "..") continue;
    struct stat status {};
    if (::fstatat(::dirfd(folder.get()), entry->d_name, &status, AT_SYMLINK_NOFOLLOW) != 0) {
      if (errno == ENOENT) continue;  // removed meanwhile
      return -1;
    }
    entries.push_back({.name = std::string(name),
                       .is_file = S_ISREG(status.st_mode),
                       .is_folder = S_ISDIR(status.st_mode),
                       .bytes = static_cast<std::uint64_t>(status.st_size),
                       .modified = time_of(status.st_mtim)});
  }
}

FileCalls& system_file_calls() {
  static FileCalls calls;
  return calls;
}

}  // namespace geosis::server
