#pragma once

#include <optional>

#include "server/auth/api_keys.h"
#include "server/http/routing/middleware.h"
#include "server/jobs/job_queue.h"
#include "server/log/log.h"
#include "server/metrics/metrics.h"

namespace geosis::server {

/// Lets requests in by their keys, and tells log and metrics what became of them. What lies below /v1 needs a key; the
/// page, /livez, /readyz, /version and the contract do not.
class RequestGate final : public http::Middleware {
 public:
  /// keys   none = anybody may do anything, as tenant `default`.
  RequestGate(std::optional<ApiKeys> keys, const JobQueue& queue, Log& log, Metrics& metrics);

  std::optional<http::Refusal> admit(http::Request& request) override;
  void answered(const http::Answered& answered) override;
  /// The queue's expected wait, 1 to 60.
  int retry_after_seconds() const override;

 private:
  const std::optional<ApiKeys> keys_;
  const JobQueue& queue_;
  Log& log_;
  Metrics& metrics_;
};

}  // namespace geosis::server
