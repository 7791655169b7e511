#pragma once

#include <cstdint>

#include "server/http/cors.h"
#include "server/http/router.h"

namespace geosis::server::http {

/// From a request to its finished reply: the handler (an exception becomes a 500 that tells nothing), conditions,
/// ranges, CORS, X-Request-Id. Knows no socket; used by any number of threads.
class Dispatcher {
 public:
  Dispatcher(Router routes, CorsOptions cors);

  /// Finds the handler and gives the request its id.
  Router::Resolved resolve(const Head& head) const;
  bool is_upload(const Router::Resolved& resolved) const;

  /// What is pending is not finished yet: resume() does that.
  Reply run(const Router::Resolved& resolved) const;
  Reply run_upload(const Router::Resolved& resolved, BodyReader& body) const;
  Reply resume(const Request& request, PendingReply& pending) const;
  Reply refuse(const Request& request, const Refusal& refusal) const;

 private:
  Reply answer_without_handler(const Router::Resolved& resolved) const;
  Reply finish(const Request& request, Reply reply) const;

  Router routes_;
  CorsOptions cors_;
};

}  // namespace geosis::server::http
