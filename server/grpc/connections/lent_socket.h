#pragma once

#include <cstdint>

#include <sys/socket.h>
#include <sys/stat.h>

namespace geosis::server::rpc {

/// A connected socket that belongs to gRPC, which tells nobody when it closes it: its number then names nothing, or
/// another file. So it is known by its inode, too.
class LentSocket {
 public:
  LentSocket() = default;
  explicit LentSocket(int number) : number_(number), inode_(inode_of(number)) {}

  int number() const { return number_; }
  std::uint64_t inode() const { return inode_; }
  bool is_open() const { return inode_ != 0 && inode_of(number_) == inode_; }

  /// Ends the connection at once; what its client sent and nobody has read yet is gone. gRPC notices and closes it.
  void reset() const {
    if (!is_open()) return;
    const sockaddr nobody{.sa_family = AF_UNSPEC, .sa_data = {}};
    if (::connect(number_, &nobody, sizeof nobody) == 0) return;  // RST, and both queues are emptied
    const linger at_once{.l_onoff = 1, .l_linger = 0};
    ::setsockopt(number_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
    ::shutdown(number_, SHUT_RDWR);
  }

 private:
  static std::uint64_t inode_of(int number) {
    struct stat status {};
    return ::fstat(number, &status) == 0 && S_ISSOCK(status.st_mode) ? status.st_ino : 0;
  }

  int number_ = -1;
  std::uint64_t inode_ = 0;
};

}  // namespace geosis::server::rpc
