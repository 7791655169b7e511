#pragma once

#include <atomic>
#include <cerrno>
#include <functional>

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "server/store/file_calls.h"

namespace geosis::test {

/// Kills the process just before its n-th system call, counted from 0: SIGKILL, no destructor runs, nothing is flushed.
class KillingCalls final : public server::FileCalls {
 public:
  explicit KillingCalls(int number) : left_(number) {}

  int open(const char* path, int flags, mode_t mode) override {
    return count(), server::FileCalls::open(path, flags, mode);
  }
  int close(int descriptor) override { return count(), server::FileCalls::close(descriptor); }
  ssize_t write(int descriptor, const void* bytes, std::size_t size) override {
    return count(), server::FileCalls::write(descriptor, bytes, size);
  }
  ssize_t pread(int descriptor, void* bytes, std::size_t size, off_t offset) override {
    return count(), server::FileCalls::pread(descriptor, bytes, size, offset);
  }
  int fsync(int descriptor) override { return count(), server::FileCalls::fsync(descriptor); }
  int flock(int descriptor, int operation) override { return count(), server::FileCalls::flock(descriptor, operation); }
  int fstat(int descriptor, struct stat* status) override {
    return count(), server::FileCalls::fstat(descriptor, status);
  }
  int stat(const char* path, struct stat* status) override { return count(), server::FileCalls::stat(path, status); }
  int lstat(const char* path, struct stat* status) override { return count(), server::FileCalls::lstat(path, status); }
  int statx(int descriptor, unsigned int mask, struct statx* status) override {
    return count(), server::FileCalls::statx(descriptor, mask, status);
  }
  int utimens_now(const char* path) override { return count(), server::FileCalls::utimens_now(path); }
  int rename(const char* from, const char* to) override { return count(), server::FileCalls::rename(from, to); }
  int unlink(const char* path) override { return count(), server::FileCalls::unlink(path); }
  int mkdir(const char* path, mode_t mode) override { return count(), server::FileCalls::mkdir(path, mode); }
  int rmdir(const char* path) override { return count(), server::FileCalls::rmdir(path); }
  char* mkdtemp(char* pattern) override { return count(), server::FileCalls::mkdtemp(pattern); }
  int list_folder(const char* path, std::vector<server::FolderEntry>& entries) override {
    return count(), server::FileCalls::list_folder(path, entries);
  }

 private:
  void count() {
    if (left_-- == 0) ::kill(::getpid(), SIGKILL);
  }

  std::atomic<int> left_;
};

/// What became of a process that did work().
enum class End { finished, killed, failed };

/// Does work() in a process of its own, which may kill itself. work   false: something went wrong. The calling process
/// must have one thread.
inline End in_own_process(const std::function<bool()>& work) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(work() ? 0 : 1);
  int status = 0;
  if (child < 0 || ::waitpid(child, &status, 0) != child) return End::failed;
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) return End::killed;
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? End::finished : End::failed;
}

}  // namespace geosis::test
