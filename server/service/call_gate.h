#pragma once

#include <optional>

#include "server/auth/api_keys.h"
#include "server/grpc/gate.h"
#include "server/jobs/job_queue.h"
#include "server/log/log.h"
#include "server/metrics/metrics.h"

namespace geosis::server {

/// Lets calls of the gRPC door in by their keys, and tells log and metrics what became of them, as RequestGate does for
/// HTTP. Health and reflection need no key.
class KeyedCallGate final : public rpc::CallGate {
 public:
  /// keys   none = anybody may do anything, as tenant `default`.
  KeyedCallGate(const std::optional<ApiKeys>& keys, const JobQueue& queue, Log& log, Metrics& metrics)
      : keys_(keys), queue_(queue), log_(log), metrics_(metrics) {}

  Result<std::string> admit(const rpc::CallHead& head) override;
  void answered(const rpc::AnsweredCall& answered) override;
  void ended_for_flooding(std::size_t connections, const std::string& last) override;
  int retry_after_seconds() const override;

 private:
  const std::optional<ApiKeys>& keys_;
  const JobQueue& queue_;
  Log& log_;
  Metrics& metrics_;
};

}  // namespace geosis::server
