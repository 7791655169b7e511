#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <grpcpp/server_context.h>
#include <grpcpp/support/status.h>

#include "engine/volume/formats/import.h"
#include "server/app/services.h"
#include "server/grpc/calls/upload_threads.h"
#include "server/grpc/gate.h"
#include "server/jobs/handler_pool.h"

namespace geosis::server::rpc {

class Call;

/// Calls that are open, so that somebody looks after those whose client does nothing.
class OpenCalls {
 public:
  void add(Call& call);
  void remove(Call& call);
  std::size_t count() const;
  /// Ends the calls whose client has been awaited for too long.
  void end_late_ones();

 private:
  mutable std::mutex mutex_;
  std::set<Call*> calls_;
};

/// What all calls share. Outlives them.
struct CallRoom {
  std::function<Services(const std::string& tenant)> services_of;
  CallGate& gate;
  HandlerPool& pool;
  UploadThreads& uploads;
  std::uint64_t upload_bytes;                 ///< largest file
  std::uint64_t upload_bytes_per_second;      ///< slower uploads are ended: each holds a thread
  std::chrono::milliseconds patience;         ///< for an upload to begin; that rate is judged as long
  std::chrono::milliseconds reader_patience;  ///< for one message to be taken
  OpenCalls open = {};
};

/// One call: who makes it, in whose name, and in the end what became of it. Any thread may call any member.
class Call {
 public:
  Call(CallRoom& room, grpc::CallbackServerContext& context, const char* method, Access access);
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;
  /// Tells the gate. Once, when gRPC is done with the call: its context is about to go.
  void over();

  /// Why it may not go on.
  const std::optional<Error>& refusal() const { return refusal_; }
  CallRoom& room() const { return room_; }
  Services services() const { return room_.services_of(tenant_); }
  const std::string& request_id() const { return head_.request_id; }
  /// The client's address, without port.
  std::string peer() const;

  void count_in(std::uint64_t bytes) { bytes_in_ += bytes; }
  void count_out(std::uint64_t bytes) { bytes_out_ += bytes; }

  /// The status to finish with.
  grpc::Status ok();
  grpc::Status failed(const Error& error, const std::vector<GridCandidate>& candidates = {});
  /// The client left, or its deadline has passed.
  void set_abandoned() { is_complete_ = false; }

  /// From now on the client is awaited; the call is cancelled when that takes too long.
  void expect_client(std::chrono::milliseconds patience);
  void client_came() { late_at_ = Clock::time_point::max(); }
  void end_if_late(std::chrono::steady_clock::time_point now);

 private:
  using Clock = std::chrono::steady_clock;

  CallRoom& room_;
  grpc::CallbackServerContext& context_;
  CallHead head_;
  std::string tenant_ = "default";
  std::optional<Error> refusal_;
  const Clock::time_point start_ = Clock::now();
  std::atomic<std::uint64_t> bytes_in_{0}, bytes_out_{0};
  std::atomic<int> status_{0};
  std::atomic<bool> is_complete_{true};
  std::atomic<Clock::time_point> late_at_{Clock::time_point::max()};
};

/// "nothing here takes this just now": what a call hears when the handlers have too much to do.
Error too_busy();

}  // namespace geosis::server::rpc
