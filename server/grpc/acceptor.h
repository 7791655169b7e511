#pragma once

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
#include "server/net/descriptor.h"
#include "server/net/listener.h"

namespace geosis::server::rpc {

/// Accepts connections in gRPC's place, on a thread of its own: it outlives the want of descriptors, refuses what is
/// too many, and knows its port. gRPC's own acceptor does none of it.
class Acceptor {
 public:
  struct Limits {
    std::size_t connections, connections_per_peer;
  };
  /// Takes over an accepted socket.
  using Hand = std::function<void(Descriptor socket)>;

  /// tick   called a few times a second.
  Acceptor(Listener listener, Limits limits, Hand hand, std::function<void()> tick);
  ~Acceptor() { stop(); }

  std::uint16_t port() const { return port_; }
  /// Connections that are open now, about.
  std::size_t connections() const { return count_; }
  /// No more connections, from now on; those waiting are refused.
  void stop();

 private:
  struct Open {
    int number;           ///< of gRPC's descriptor
    std::uint64_t inode;  ///< another one: it was closed, and the number is somebody else's
    std::string peer;
  };
  void run();
  void accept_all();
  void forget_closed();
  bool has_room_for(const std::string& peer);

  Listener listener_;
  const std::uint16_t port_;
  const Limits limits_;
  const Hand hand_;
  const std::function<void()> tick_;
  Descriptor wake_;
  std::atomic<bool> is_stopping_{false};
  std::atomic<std::size_t> count_{0};
  std::vector<Open> open_;  ///< of the thread
  std::thread thread_;
};

}  // namespace geosis::server::rpc
