#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "server/grpc/connections/connection_counts.h"

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
    std::uint64_t of_all;       ///< of all, calls that are being served left out; beyond, no connections are taken
  };
  struct Limits {
    Bound calls, bytes;
    std::uint64_t message_bytes;   ///< of the largest one: added to bytes.of_one for each call that is held
    std::uint64_t head_bytes;      ///< of the largest one of a call
    std::uint64_t unlooked_bytes;  ///< that a connection may send before it is looked at
  };
  struct Open {
    std::string name;         ///< connection_name()
    std::uint64_t bytes = 0;  ///< read from it, ever
    bool was_ended = false;   ///< and still holds what it held
  };
  struct Verdict {
    std::vector<std::string> harmful;  ///< connections to be ended, by name
    bool is_full = false;              ///< no connections should be taken now
  };

  explicit FloodGuard(Limits limits) : limits_(limits) {}

  /// What to do now with the connections that are open.
  ///
  /// served   calls that somebody is working at.
  /// cost     nothing for connections of which little was read since they were looked at; 20 microseconds for each
  ///          other one, and 1 for each that is open.
  Verdict look(const std::vector<Open>& open, std::uint64_t served);

  /// The same of given counts. Connections without any are as they were.
  Verdict judge(const std::vector<Open>& open, std::uint64_t served, const std::vector<ConnectionCounts>& counts);

 private:
  /// What is known of a connection.
  struct Known {
    struct {
      std::uint64_t messages = 0, begun = 0, bytes = 0;
    } step;                            ///< when a message was last whole
    std::uint64_t looked = 0;          ///< bytes, at its last look
    std::uint64_t held = 0, vain = 0;  ///< calls; bytes since a message was whole
  };
  std::set<std::string> moved(const std::vector<Open>& open) const;
  Known known(const Open& one, const ConnectionCounts* counts) const;

  const Limits limits_;
  std::map<std::string, Known> known_;  ///< by name, of those that are open
};

}  // namespace geosis::server::rpc
