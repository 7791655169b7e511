#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "engine/base/result.h"
#include "server/grpc/connections/flood_guard.h"
#include "server/grpc/connections/lent_socket.h"
#include "server/net/descriptor.h"
#include "server/net/listener.h"

namespace geosis::server::rpc {

/// Accepts connections in gRPC's place, on a thread of its own: it outlives the want of descriptors, refuses what is
/// too many, ends what floods, and knows its port. gRPC's own acceptor does none of it.
///
/// A connection that was ended keeps its memory until gRPC has let go of it. As long as one of a peer does, up to a
/// second or so, his further ones wait: who floods and comes back has one flood at a time.
class Acceptor {
 public:
  struct Limits {
    std::size_t connections, connections_per_peer;
    std::chrono::milliseconds longest_wait{1000};  ///< of a peer for what of his is being ended
  };
  /// Takes over accepted sockets.
  struct Hand {
    std::function<bool()> has_room;  ///< else those that come wait with the system
    /// Must not block: while it does, nobody looks.
    std::function<void(Descriptor socket, const std::string& name)> take;
  };

  /// What becomes of connections that are there, and whether others may come; asked every 20 ms while there are any.
  using Look = std::function<FloodGuard::Verdict(const std::vector<FloodGuard::Open>&)>;

  /// tick   called a few times a second.
  Acceptor(Listener listener, Limits limits, Hand hand, Look look, std::function<void()> tick);
  ~Acceptor() { stop(); }

  std::uint16_t port() const { return port_; }
  /// Connections that are open now, about.
  std::size_t connections() const { return count_; }
  /// Whether some that come may have to wait or are refused.
  bool may_be_full() const { return is_full_ || count_ >= std::min(limits_.connections, limits_.connections_per_peer); }
  /// No more connections, from now on; those waiting are refused.
  void stop();

 private:
  struct Open {
    LentSocket socket;
    std::string peer;
    std::string name;        ///< connection_name()
    bool was_ended = false;  ///< by us
  };
  struct Waiting {
    Descriptor socket;
    std::string peer, name;
    std::chrono::steady_clock::time_point since;
  };
  void run();
  void look();
  void end(const std::vector<std::string>& harmful);
  void hand_waiting();
  bool has_ending(const std::string& peer) const;
  bool is_open(const std::string& name) const;
  void accept_all();
  void forget_closed();
  bool has_room_for(const std::string& peer);

  Listener listener_;
  const std::uint16_t port_;
  const Limits limits_;
  const Hand hand_;
  const Look look_;
  const std::function<void()> tick_;
  Descriptor wake_;
  std::atomic<bool> is_stopping_{false};
  std::atomic<std::size_t> count_{0};
  std::atomic<bool> is_full_{false};  ///< by the last look's verdict
  // Of the thread:
  std::vector<Open> open_;
  std::vector<Waiting> waiting_;  ///< accepted: they are among open_, too
  std::thread thread_;
};

}  // namespace geosis::server::rpc
