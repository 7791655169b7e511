#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "server/grpc/connections/connection_counts.h"

namespace geosis::server::rpc {

/// Finds connections whose client costs memory for nothing. Debian's gRPC bounds what is open, and has no bound for
///
///   calls that are reset at once   each holds 6 KiB until a thread has got round to it; others wait behind them
///   heads that go on for long      its limit begins anew with each frame
///   pings                          their answers wait for a client who does not read
///
/// which took a gigabyte within seconds. All show in what gRPC and the kernel count of each connection:
///
///   leftover calls   held, beyond those that may be open
///   loose bytes      came since a message was whole and may be held: without heads within the limit, and without a
///                    message for each call that is over
class FloodGuard {
 public:
  struct Bound {
    std::uint64_t of_one;  ///< of one connection; beyond, it is ended
    std::uint64_t of_all;  ///< beyond, whoever has more than his share is ended, and no connections are taken meanwhile
  };
  struct Limits {
    std::uint64_t open_calls;  ///< of one connection
    Bound leftover_calls;
    Bound loose_bytes;             ///< and a message for each call: of one that it holds, of all that are served
    std::uint64_t message_bytes;   ///< of the largest one
    std::uint64_t most_messages;   ///< that clients may be sending at one time
    std::uint64_t head_bytes;      ///< of the largest one of a call
    std::uint64_t unlooked_bytes;  ///< that a connection may send before it is looked at
    std::uint64_t patience;        ///< looks: how long loose bytes may lie still while all have too many
  };
  struct Open {
    std::string name;         ///< connection_name(); no two have the same
    std::uint64_t id = 0;     ///< another one: another connection, even of that name
    std::uint64_t bytes = 0;  ///< read from it, ever
    bool was_ended = false;   ///< and still holds what it held
  };
  struct Verdict {
    std::vector<std::string> harmful;  ///< connections to be ended, by name
    bool is_full = false;              ///< no connections should be taken now
  };
  /// As count_connections().
  using Count = std::function<std::vector<ConnectionCounts>(const std::function<bool(const std::string& name)>&)>;

  explicit FloodGuard(Limits limits, Count count = count_connections) : limits_(limits), count_(std::move(count)) {}

  /// What to do now with the connections that are open. To be called at equal intervals.
  ///
  /// served   calls that somebody is working at.
  /// cost     20 microseconds for each connection of which more than a little was read since it was looked at, or each
  ///          one if that is too much for all; 1 for each other one.
  Verdict look(const std::vector<Open>& open, std::uint64_t served);

 private:
  /// What is known of a connection.
  struct Known {
    std::uint64_t id = 0;
    std::uint64_t messages = 0, begun = 0, held = 0, bytes = 0;  ///< at its last look
    std::uint64_t loose = 0;                                     ///< bytes
    std::uint64_t seen = 0, still = 0;                           ///< bytes by now; looks since there were fewer
  };
  struct Sums {
    std::uint64_t leftover = 0, loose = 0;
  };
  std::set<std::string> moved(const std::vector<Open>& open) const;
  void pass_by(const std::vector<Open>& open);
  void learn(const std::vector<Open>& open, const std::set<std::string>& names);
  void learn(Known& known, const Open& one, const ConnectionCounts* counts) const;
  std::uint64_t leftover(const Known& known) const;
  Sums sums() const;
  bool is_too_much(const Sums& sums, std::uint64_t served) const;
  Verdict judge(const std::vector<Open>& open, const Sums& sums, std::uint64_t served) const;

  const Limits limits_;
  const Count count_;
  std::map<std::string, Known> known_;  ///< by name, of those that are open
};

}  // namespace geosis::server::rpc
