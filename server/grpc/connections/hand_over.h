#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "server/grpc/connections/lent_socket.h"
#include "server/net/descriptor.h"

namespace geosis::server::rpc {

/// Hands accepted sockets to gRPC, on a few threads of its own.
///
/// Whoever hands one over works for gRPC until that connection has nothing more to read. That is soon with clients who
/// wait for answers, as flow control and the number of open calls make all of them do, and not before its end with one
/// who sends frames without bound. The acceptor must not be caught by that: it is who ends such connections.
class HandOver {
 public:
  /// Takes a socket over. Each is called by one thread, never twice at a time.
  using Lane = std::function<void(Descriptor socket)>;

  /// patience   how long a connection may keep a lane while others wait for one.
  HandOver(std::vector<Lane> lanes, std::chrono::milliseconds patience);
  ~HandOver() { stop(); }

  /// Whether what is handed over now is soon taken. What waits with the system instead costs nothing, and may have been
  /// given up by then.
  bool has_room();
  /// name   of the connection.
  void hand(Descriptor socket, std::string name);
  /// The connection that has kept its lane longest, if others wait and that is too long: it should be ended. Each once.
  std::optional<std::string> stuck();
  /// Waits until no lane is kept, for as long as one may be; ends those that still are, and what waits.
  void stop();

 private:
  using Clock = std::chrono::steady_clock;
  struct Waiting {
    Descriptor socket;
    std::string name;
  };
  struct Kept {
    LentSocket socket;
    std::string name;
    Clock::time_point since;
    bool was_named = false;  ///< by stuck()
  };
  void run(std::size_t lane);

  const std::vector<Lane> lanes_;
  const std::chrono::milliseconds patience_;
  std::mutex mutex_;
  std::condition_variable came_, left_;
  std::deque<Waiting> waiting_;
  std::vector<std::optional<Kept>> kept_;  ///< by lane
  bool is_stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace geosis::server::rpc
