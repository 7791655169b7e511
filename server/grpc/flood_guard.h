#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "server/grpc/connection_counts.h"

namespace geosis::server::rpc {

/// Finds connections whose client costs memory for nothing. Debian's gRPC bounds what is open, and has no bound for
///
///   calls that are reset at once    each holds 6 KiB until a thread has got round to it; others wait behind them
///   heads that go on for long       to clients who do not confirm its settings it applies no limit of theirs
///
/// which took a gigabyte within seconds. Both show in what gRPC and the kernel count of each connection.
class FloodGuard {
 public:
  /// Of calls that are held, or of bytes that came since a message was whole, those of heads within the limit left out.
  struct Bound {
    std::uint64_t of_one;       ///< of one connection
    std::uint64_t of_one_then;  ///< the same while `of_all` is exceeded
    std::uint64_t of_all;       ///< beyond, no connections are taken
  };
  struct Limits {
    Bound calls, bytes;
    std::uint64_t message_bytes;  ///< of the largest one: added to bytes.of_one for each call that is held
    std::uint64_t head_bytes;     ///< of the largest one of a call
  };
  struct Open {
    std::string name;         ///< connection_name()
    std::uint64_t bytes = 0;  ///< read from it, ever
  };
  struct Verdict {
    std::vector<std::string> harmful;  ///< connections to be ended, by name
    bool is_full = false;              ///< no connections should be taken now
  };

  explicit FloodGuard(Limits limits) : limits_(limits) {}

  /// What to do now with the connections that are open. cost: 20 microseconds, and as many for each connection while
  /// one of them is suspected.
  Verdict look(const std::vector<Open>& open);

  /// The same of given counts.
  Verdict judge(const std::vector<Open>& open, std::uint64_t held, const std::vector<ConnectionCounts>& counts);

 private:
  /// A connection when a message was last whole.
  struct Step {
    std::uint64_t messages, begun, bytes;
  };
  bool is_suspicious(const std::vector<Open>& open) const;

  const Limits limits_;
  std::map<std::string, Step> steps_;  ///< by name, of those that were judged
};

}  // namespace geosis::server::rpc
