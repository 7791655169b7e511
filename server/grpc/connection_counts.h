#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace geosis::server::rpc {

// What gRPC counts of itself (channelz), and the kernel of its sockets.

struct ConnectionCounts {
  std::string connection;  ///< the client's address as gRPC writes it, "ipv4:127.0.0.1:43682", "ipv6:%5B::1%5D:43682"
  /// Calls that gRPC has begun and not yet let go of. That is more than the calls that are open: one that its client
  /// resets is closed at once, and holds its memory until a thread has got round to it.
  std::uint64_t held = 0;
  std::uint64_t begun = 0;     ///< calls, ever
  std::uint64_t messages = 0;  ///< received and sent whole, ever
};

/// Calls that are held, by all servers of this process. cost: 20 microseconds.
std::uint64_t held_calls();

/// Of each connection of all servers of this process. cost: 20 microseconds each.
std::vector<ConnectionCounts> counts_by_connection();

/// The client's address of a connected socket, as gRPC writes it; empty for what is none.
std::string connection_name(int socket);

/// Bytes that have arrived at a socket and were read, ever; 0 for what is none. cost: 2 system calls.
std::uint64_t bytes_read(int socket);

}  // namespace geosis::server::rpc
