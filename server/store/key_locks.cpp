#include "server/store/key_locks.h"

#include <cerrno>
#include <string>

#include <fcntl.h>
#include <sys/file.h>
#include <xxhash.h>

namespace geosis::server {
namespace {

constexpr std::uint64_t kLocks = 64;
constexpr mode_t kFileMode = 0666;  // less the umask

}  // namespace

Result<OpenFile> KeyLocks::take(std::string_view key) {
  const std::filesystem::path path = folder_ / std::to_string(XXH3_64bits(key.data(), key.size()) % kLocks);
  OpenFile file(calls_, calls_.open(path.c_str(), O_RDWR | O_CREAT, kFileMode));
  if (!file.is_open()) return file_error(path, "cannot open this lock", errno);
  if (calls_.flock(file.descriptor(), LOCK_EX) != 0) return file_error(path, "cannot take this lock", errno);
  return file;
}

}  // namespace geosis::server
