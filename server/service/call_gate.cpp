#include "server/service/call_gate.h"

#include <array>
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "server/auth/admission.h"
#include "server/service/retry_after.h"

namespace geosis::server {
namespace {

/// As google.rpc.Code calls its numbers.
const char* status_name(int status) {
  static constexpr std::array<const char*, 17> kNames = {
      "OK",        "CANCELLED",      "UNKNOWN",           "INVALID_ARGUMENT",   "DEADLINE_EXCEEDED",
      "NOT_FOUND", "ALREADY_EXISTS", "PERMISSION_DENIED", "RESOURCE_EXHAUSTED", "FAILED_PRECONDITION",
      "ABORTED",   "OUT_OF_RANGE",   "UNIMPLEMENTED",     "INTERNAL",           "UNAVAILABLE",
      "DATA_LOSS", "UNAUTHENTICATED"};
  return status >= 0 && status < static_cast<int>(kNames.size()) ? kNames[static_cast<std::size_t>(status)] : "UNKNOWN";
}

constexpr int kInternal = 13;

}  // namespace

int KeyedCallGate::retry_after_seconds() const {
  return retry_after(queue_);
}

Result<std::string> KeyedCallGate::admit(const rpc::CallHead& head) {
  auto caller = admit_caller(keys_, head.authorization, head.access == rpc::Access::write);
  if (!caller) return std::move(caller).error();
  return std::move(caller->tenant);
}

void KeyedCallGate::answered(const rpc::AnsweredCall& answered) {
  const double seconds = std::chrono::duration<double>(answered.duration).count();
  const std::string status = status_name(answered.status);
  metrics_.observe("geosis_grpc_call_seconds", {{"method", answered.method}, {"status", status}}, seconds);
  metrics_.add("geosis_grpc_received_bytes_total", {}, static_cast<double>(answered.bytes_in));
  metrics_.add("geosis_grpc_sent_bytes_total", {}, static_cast<double>(answered.bytes_out));
  std::vector<LogField> fields = {{"request_id", answered.request_id},
                                  {"method", answered.method},
                                  {"status", status},
                                  {"seconds", seconds},
                                  {"in", static_cast<std::int64_t>(answered.bytes_in)},
                                  {"out", static_cast<std::int64_t>(answered.bytes_out)},
                                  {"tenant", answered.tenant}};
  if (!answered.trace_id.empty()) fields.push_back({"trace_id", answered.trace_id});
  if (!answered.is_complete) fields.push_back({"complete", std::string("no")});
  log_.write(answered.status == kInternal ? LogLevel::error : LogLevel::info, "call", fields);
}

void KeyedCallGate::ended_for_flooding(std::size_t connections, const std::string& last) {
  metrics_.add("geosis_grpc_floods_total", {}, static_cast<double>(connections));
  log_.write(LogLevel::warning, "connections ended for flooding",
             {{"connections", static_cast<std::int64_t>(connections)}, {"last", last}});
}

}  // namespace geosis::server
