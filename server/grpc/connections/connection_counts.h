#pragma once

#include <cstdint>
#include <functional>
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

/// Of those connections of all servers of this process whose names are wanted. cost: 20 microseconds each, and 1 for
/// each other one.
std::vector<ConnectionCounts> count_connections(const std::function<bool(const std::string& name)>& is_wanted);

/// The client's address of a connected socket, as gRPC writes it; empty for what is none.
std::string connection_name(int socket);

/// Bytes that have arrived at a socket and were read, ever; 0 for what is none. Fewer than there are, when some arrive
/// meanwhile. cost: 2 system calls.
std::uint64_t bytes_read(int socket);

}  // namespace geosis::server::rpc
