#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>

#include "engine/base/result.h"

namespace geosis::server::rpc {

/// What a method does to what others see, and so which scope it needs.
enum class Access { read, write };

/// A call as it arrives.
struct CallHead {
  std::string method;  ///< "geosis.v1.VolumeService/GetVolume"
  std::string authorization, request_id, trace_id;
  Access access = Access::read;
};

/// One call and what became of it.
struct AnsweredCall {
  std::string method, request_id, trace_id, tenant;
  int status = 0;  ///< as google.rpc.Code numbers them
  std::uint64_t bytes_in = 0, bytes_out = 0;
  std::chrono::nanoseconds duration{};
  bool is_complete = true;  ///< false: the client left before its answer was whole
};

/// What stands between the door and the services: who may call, and who is told of it. Outlives the door; called from
/// any thread, and must not block.
class CallGate {
 public:
  virtual ~CallGate() = default;
  /// The tenant in whose name the call is made. errors: unauthenticated, permission_denied.
  virtual Result<std::string> admit(const CallHead& head) = 0;
  /// Once for each call, when it is over.
  virtual void answered(const AnsweredCall& answered) = 0;
  /// Connections that were ended for flooding the door since it was last said, at most once a second; and the address
  /// of one of them.
  virtual void ended_for_flooding(std::size_t connections, const std::string& last) {
    static_cast<void>(connections);
    static_cast<void>(last);
  }
  /// What refusals for lack of room say in RetryInfo.
  virtual int retry_after_seconds() const { return 1; }
};

}  // namespace geosis::server::rpc
