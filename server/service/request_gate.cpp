#include "server/service/request_gate.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace geosis::server {
namespace {

constexpr std::string_view kScheme = "bearer ";
constexpr double kLeastWait = 1, kLongestWait = 60;  // seconds

/// The key of "Authorization: Bearer KEY"; nothing in any other form.
std::optional<std::string_view> key_of(const http::Request& request) {
  const std::string* const header = request.header("authorization");
  if (header == nullptr || header->size() <= kScheme.size()) return std::nullopt;
  if (http::lower_case(std::string_view(*header).substr(0, kScheme.size())) != kScheme) return std::nullopt;
  return http::trimmed(std::string_view(*header).substr(kScheme.size()));
}

bool is_open(const http::Request& request) {
  return !request.route.starts_with("/v1/");
}

/// What changes nothing that others see needs only the scope to read: a question, and asking for what can be computed.
bool is_read(const http::Request& request) {
  if (request.method == "GET" || request.method == "HEAD") return true;
  if (request.route == "/v1/volumes/*/extractions") return true;
  return request.method == "DELETE" && request.route == "/v1/extractions/*" && !request.query.contains("purge");
}

std::string status_text(int status) {
  return std::to_string(status);
}

}  // namespace

RequestGate::RequestGate(std::optional<ApiKeys> keys, const JobQueue& queue, Log& log, Metrics& metrics)
    : keys_(std::move(keys)), queue_(queue), log_(log), metrics_(metrics) {}

int RequestGate::retry_after_seconds() const {
  return static_cast<int>(std::clamp(std::ceil(queue_.expected_wait().count()), kLeastWait, kLongestWait));
}

std::optional<http::Refusal> RequestGate::admit(http::Request& request) {
  if (!keys_ || is_open(request)) return std::nullopt;
  const auto key = key_of(request);
  if (!key) return http::Refusal{401, "this needs a key: Authorization: Bearer KEY"};
  const Caller* const caller = keys_->find(*key);
  if (caller == nullptr) return http::Refusal{401, "nobody knows this key"};
  request.tenant = caller->tenant;
  const bool may = is_read(request) ? caller->scopes.read : caller->scopes.write;
  if (may) return std::nullopt;
  return http::Refusal{403,
                       std::string("this needs the scope ") + (is_read(request) ? "volumes:read" : "volumes:write")};
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
  log_.write(answered.status >= 500 && answered.status != 503 ? LogLevel::error : LogLevel::info, "request", fields);
}

}  // namespace geosis::server
