#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "engine/base/result.h"
#include "server/app/services.h"
#include "server/grpc/gate.h"
#include "server/jobs/slots.h"
#include "server/net/tls_certificates.h"

namespace geosis::server::rpc {

struct DoorOptions {
  std::string listen = "127.0.0.1:8081";    ///< "host:port"; port 0 = any that is free
  TlsCertificates* certificates = nullptr;  ///< outlive the door; null = plain HTTP/2
  std::size_t connections = 256, connections_per_peer = 64;
  int streams_per_connection = 64;
  std::size_t handler_threads = 8;
  std::size_t queued_calls = 256;  ///< that wait for a handler's thread; more are UNAVAILABLE
  std::uint64_t upload_bytes = std::uint64_t{1} << 36;
  std::chrono::milliseconds patience{10'000};          ///< for an upload's first bytes; its rate is judged as long
  std::chrono::milliseconds reader_patience{120'000};  ///< for one message of 256 KiB to be taken
  std::chrono::milliseconds probe_interval{10'000};
};

/// The gRPC door: geosis.v1's services, health and reflection, over the use cases that HTTP opens too.
///
/// gRPC's threads only move bytes. Calls are done on a few threads of ours and may read the store; what computes runs
/// in the queue; each upload has a thread. Connections are accepted by us (Acceptor), so that gRPC 1.51 can neither
/// stop accepting nor take more of them than it may.
class Door {
 public:
  /// What the door opens. Outlives it.
  struct Parts {
    std::function<Services(const std::string& tenant)> services_of;
    CallGate& gate;
    Slots& uploads;                                         ///< threads for uploads, shared with other doors
    std::function<void(const std::string& line)> say = {};  ///< what gRPC has to say; from any thread
    std::function<void()> give_back = [] {};                ///< called when much memory has just become free
  };

  /// Listens and serves until stop(). SIGTERM and the like must be blocked before: gRPC's threads inherit the mask.
  ///
  /// errors   invalid_argument (address, certificate), unavailable (port taken, no descriptors).
  static Result<std::unique_ptr<Door>> start(const DoorOptions& options, const Parts& parts);
  ~Door();

  std::uint16_t port() const;
  std::size_t connections() const;
  std::size_t calls() const;
  /// Why it is dead and should be started again; nothing while it answers its own questions.
  std::optional<std::string> not_alive() const;

  /// Health says NOT_SERVING; all is served as before, for those who have not asked yet.
  void set_not_serving();
  /// Health says NOT_SERVING, and no connections and calls are taken any more; running ones may finish within `grace`,
  /// the rest is cancelled.
  void drain(std::chrono::milliseconds grace);
  /// Cancels what still runs. May be called twice.
  void stop();

 private:
  class Running;
  explicit Door(std::unique_ptr<Running> running);

  std::unique_ptr<Running> running_;
};

}  // namespace geosis::server::rpc
