#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <sys/stat.h>
#include <sys/types.h>

namespace geosis::server {

struct FolderEntry {
  std::string name;
  bool is_file = false;  ///< a regular file; a symbolic link is neither
  bool is_folder = false;
  std::uint64_t bytes = 0;
  std::chrono::system_clock::time_point modified{};
};

/// The system calls behind a directory store, each with the kernel's meaning: -1 and errno on failure. Interrupted
/// calls are made again. A test derives from it to let the n-th call fail.
class FileCalls {
 public:
  virtual ~FileCalls() = default;

  virtual int open(const char* path, int flags, mode_t mode);
  virtual int close(int descriptor);
  virtual ssize_t write(int descriptor, const void* bytes, std::size_t count);
  virtual ssize_t pread(int descriptor, void* bytes, std::size_t count, off_t offset);
  virtual int fsync(int descriptor);
  virtual int flock(int descriptor, int operation);
  virtual int fstat(int descriptor, struct stat* status);
  virtual int stat(const char* path, struct stat* status);
  virtual int lstat(const char* path, struct stat* status);
  virtual int statx(int descriptor, unsigned int mask, struct statx* status);
  virtual int utimens_now(const char* path);  ///< sets the times of a file to the present
  virtual int rename(const char* from, const char* to);
  virtual int unlink(const char* path);
  virtual int mkdir(const char* path, mode_t mode);
  virtual int rmdir(const char* path);
  virtual char* mkdtemp(char* pattern);  ///< null on failure
  /// All entries of a folder but "." and "..", unsorted.
  virtual int list_folder(const char* path, std::vector<FolderEntry>& entries);
};

/// The kernel's own. Lives as long as the process.
FileCalls& system_file_calls();

}  // namespace geosis::server
