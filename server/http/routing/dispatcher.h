#pragma once

#include <cstdint>

#include "server/http/routing/cors.h"
#include "server/http/routing/middleware.h"
#include "server/http/routing/router.h"

namespace geosis::server::http {

/// From a request to its finished reply: the handler (an exception becomes a 500 that tells nothing), conditions,
/// ranges, CORS, X-Request-Id, and the middleware's say. Knows no socket; used by any number of threads.
class Dispatcher {
 public:
  using Clock = std::chrono::steady_clock;

  /// middleware   may be null.
  Dispatcher(Router routes, CorsOptions cors, Middleware* middleware = nullptr);

  /// Finds the handler, gives the request its ids and asks whether it may go on.
  ///
  /// received   when its head was complete.
  Router::Resolved resolve(const Head& head, Clock::time_point received = Clock::now()) const;
  bool is_upload(const Router::Resolved& resolved) const;

  /// The answer, if there is one that takes no time.
  std::optional<Reply> run_quickly(const Router::Resolved& resolved) const;
  /// What is pending is not finished yet: resume() does that.
  Reply run(const Router::Resolved& resolved) const;
  Reply run_upload(const Router::Resolved& resolved, BodyReader& body) const;
  Reply resume(const Request& request, PendingReply& pending) const;
  Reply refuse(const Request& request, const Refusal& refusal) const;

 private:
  Reply answer_without_handler(const Router::Resolved& resolved) const;
  Reply finish(const Request& request, Reply reply, std::uint64_t bytes_in = 0) const;

  Router routes_;
  CorsOptions cors_;
  Middleware* middleware_;
};

}  // namespace geosis::server::http
