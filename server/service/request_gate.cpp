#include "server/service/request_gate.h"

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "server/app/errors.h"
#include "server/auth/admission.h"
#include "server/service/retry_after.h"

namespace geosis::server {
namespace {

bool is_open(const http::Request& request) {
  return !request.route.starts_with("/v1/");
}

/// What changes nothing that others see needs only the scope to read: a question, and asking for what can be computed.
bool is_read(const http::Request& request) {
  if (request.method == "GET" || request.method == "HEAD") return true;
  if (request.route == "/v1/volumes/*/extractions") return true;
  return request.method == "DELETE" && request.route == "/v1/extractions/*" && !request.query.contains("purge");
}

/// Neither load nor what the client asked for.
bool is_our_fault(int status) {
  return status >= 500 && status != 501 && status != 503 && status != 505;
}

std::string status_text(int status) {
  return std::to_string(status);
}

}  // namespace

RequestGate::RequestGate(std::optional<ApiKeys> keys, const JobQueue& queue, Log& log, Metrics& metrics)
    : keys_(std::move(keys)), queue_(queue), log_(log), metrics_(metrics) {}

int RequestGate::retry_after_seconds() const {
  return retry_after(queue_);
}

std::optional<http::Refusal> RequestGate::admit(http::Request& request) {
  if (!keys_ || is_open(request)) return std::nullopt;
  const std::string* const authorization = request.header("authorization");
  auto caller = admit_caller(keys_, authorization ? std::string_view(*authorization) : "", !is_read(request));
  if (!caller) return http::Refusal{numbers_of(caller.error().code).http_status, caller.error().message};
  request.tenant = std::move(caller->tenant);
  return std::nullopt;
}

void RequestGate::answered(const http::Answered& answered) {
  const double seconds = std::chrono::duration<double>(answered.duration).count();
  const std::string route = answered.route.empty() ? "none" : answered.route;
  metrics_.observe("geosis_http_request_seconds",
                   {{"method", answered.route.empty() ? "none" : answered.method},
                    {"route", route},
                    {"status", status_text(answered.status)}},
                   seconds);
  metrics_.add("geosis_http_received_bytes_total", {}, static_cast<double>(answered.bytes_in));
  metrics_.add("geosis_http_sent_bytes_total", {}, static_cast<double>(answered.bytes_out));
  std::vector<LogField> fields = {{"request_id", answered.request_id},
                                  {"method", answered.method},
                                  {"path", answered.path},
                                  {"status", std::int64_t{answered.status}},
                                  {"seconds", seconds},
                                  {"in", static_cast<std::int64_t>(answered.bytes_in)},
                                  {"out", static_cast<std::int64_t>(answered.bytes_out)},
                                  {"tenant", answered.tenant}};
  if (!answered.trace_id.empty()) fields.push_back({"trace_id", answered.trace_id});
  if (!answered.is_complete) fields.push_back({"complete", std::string("no")});
  log_.write(is_our_fault(answered.status) ? LogLevel::error : LogLevel::info, "request", fields);
}

}  // namespace geosis::server
