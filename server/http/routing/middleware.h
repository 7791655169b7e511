#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "server/http/routing/exchange.h"
#include "server/http/wire/head_parser.h"

namespace geosis::server::http {

/// One request and what became of it.
struct Answered {
  std::string method, path;
  std::string route;  ///< the pattern that matched, with * for what varies; empty = nothing matched
  std::string request_id, trace_id, tenant;
  int status = 0;
  std::uint64_t bytes_in = 0;           ///< of the body, decoded
  std::uint64_t bytes_out = 0;          ///< on the wire
  std::chrono::nanoseconds duration{};  ///< from the complete head to the last byte written
  bool is_complete = false;             ///< false: the client left, or the answer broke
};

/// What stands between the front and the handlers: who may call, and who is told of it. Outlives the front; called from
/// any thread, and must not block.
class Middleware {
 public:
  virtual ~Middleware() = default;
  /// Once for each request that has a handler, before its body is read. Sets the request's tenant, or refuses.
  virtual std::optional<Refusal> admit(Request& request) = 0;
  /// Once for each request, when its answer is written or given up, or its client left while the answer was pending
  /// (status 499, which no client ever sees).
  virtual void answered(const Answered& answered) = 0;
  /// What 503 and 429 say in Retry-After. From any thread, quickly.
  virtual int retry_after_seconds() const { return 1; }
};

}  // namespace geosis::server::http
