#pragma once

#include <cstdint>
#include <string>

#include "engine/base/result.h"
#include "server/net/descriptor.h"

namespace geosis::server {

/// A listening TCP socket that outlives every failure of accept().
class Listener {
 public:
  /// address   "host:port", "[::1]:port"; port 0 = any that is free. errors: invalid_argument, unavailable.
  static Result<Listener> open(const std::string& address);

  struct Accepted {
    enum class Outcome {
      connection,
      none,       ///< nobody waits any more
      exhausted,  ///< the system lacks descriptors or memory: try again later
    };
    Outcome outcome = Outcome::none;
    Descriptor socket;  ///< non-blocking, without Nagle's delay; notices a peer that vanished
    std::string peer;   ///< address without port; of an IPv6 one its /64, which is what one client owns
  };
  Accepted accept();

  int descriptor() const { return socket_.number(); }
  std::uint16_t port() const { return port_; }
  bool is_open() const { return socket_.is_open(); }
  void close() { socket_.close(); }

 private:
  Listener(Descriptor socket, std::uint16_t port);
  void shed_one();

  Descriptor socket_;
  /// Given up for a moment when descriptors run out, so that a waiting connection can be taken and closed: it learns
  /// of its refusal, and the level-triggered loop does not spin on it.
  Descriptor reserve_;
  std::uint16_t port_ = 0;
};

}  // namespace geosis::server
