#include "server/http/routing/cors.h"

#include <algorithm>

namespace geosis::server::http {
namespace {

constexpr const char* kExposedHeaders =
    "ETag, Location, Content-Range, Retry-After, X-Geosis-Shape, X-Geosis-Transform, X-Request-Id";
constexpr const char* kAcceptedHeaders =
    "Accept, Authorization, Content-Digest, Content-Type, If-None-Match, Last-Event-ID, Prefer, Priority, Range, "
    "Traceparent, X-Request-Id";
constexpr const char* kPreflightSeconds = "600";

bool contains(const std::vector<std::string>& values, const std::string& value) {
  return std::find(values.begin(), values.end(), value) != values.end();
}

/// Access-Control-Allow-Origin for a request by `method`; empty = none.
std::string allowed_origin(const CorsOptions& options, const std::string& origin, const std::string& method) {
  if (contains(options.origins, origin)) return origin;
  const bool reads = method == "GET" || method == "HEAD";
  return reads && contains(options.origins, "*") ? "*" : "";
}

bool add_origin(const CorsOptions& options, const Request& request, const std::string& method, Reply& reply) {
  if (options.origins.empty()) return false;
  reply.headers.emplace_back("Vary", "Origin");
  const std::string* origin = request.header("origin");
  const std::string allowed = origin ? allowed_origin(options, *origin, method) : "";
  if (allowed.empty()) return false;
  reply.headers.emplace_back("Access-Control-Allow-Origin", allowed);
  return true;
}

}  // namespace

void apply_cors(const CorsOptions& options, const Request& request, Reply& reply) {
  if (add_origin(options, request, request.method, reply)) {
    reply.headers.emplace_back("Access-Control-Expose-Headers", kExposedHeaders);
  }
}

Reply options_reply(const CorsOptions& options, const Request& request, const std::string& allowed) {
  Reply reply;
  reply.status = 204;
  reply.headers.emplace_back("Allow", allowed);
  const std::string* method = request.header("access-control-request-method");
  if (method && add_origin(options, request, *method, reply)) {
    // Not the path's methods: under "*" only reads are given away.
    reply.headers.emplace_back("Access-Control-Allow-Methods", *method);
    reply.headers.emplace_back("Access-Control-Allow-Headers", kAcceptedHeaders);
    reply.headers.emplace_back("Access-Control-Max-Age", kPreflightSeconds);
  }
  return reply;
}

}  // namespace geosis::server::http
