#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/grpc/held_calls.h"

namespace geosis::server::rpc {

/// Finds connections whose client begins calls faster than gRPC lets go of them, by resetting each at once: Debian's
/// gRPC bounds the calls that are open, and 6 KiB of each that was reset stay until a thread has got round to it. With
/// nobody looking that was a gigabyte within two seconds.
class FloodGuard {
 public:
  struct Limits {
    std::uint64_t of_one;       ///< calls that one connection may hold
    std::uint64_t of_one_then;  ///< the same while `of_all` is exceeded
    std::uint64_t of_all;       ///< beyond, no connections are taken
  };
  struct Verdict {
    std::vector<std::string> harmful;  ///< connections to be ended, by name
    bool is_full = false;              ///< no connections should be taken now
  };

  explicit FloodGuard(Limits limits) : limits_(limits) {}

  /// What to do now. cost: held_calls(), and while there are many held_calls_by_connection().
  Verdict look() const;

  /// The same of given counts.
  Verdict judge(std::uint64_t of_all, const std::vector<HeldCalls>& of_each) const;

 private:
  Limits limits_;
};

}  // namespace geosis::server::rpc
