#include "server/grpc/calls/call.h"

#include "server/app/errors.h"
#include "server/grpc/messages/error_status.h"
#include "server/net/request_ids.h"

namespace geosis::server::rpc {
namespace {

std::string metadata_of(const grpc::CallbackServerContext& context, const char* name) {
  const auto& metadata = context.client_metadata();
  const auto found = metadata.find(name);
  return found == metadata.end() ? std::string() : std::string(found->second.data(), found->second.size());
}

}  // namespace

// ---- open calls

void OpenCalls::add(Call& call) {
  const std::lock_guard lock(mutex_);
  calls_.insert(&call);
}

void OpenCalls::remove(Call& call) {
  const std::lock_guard lock(mutex_);
  calls_.erase(&call);
}

std::size_t OpenCalls::count() const {
  const std::lock_guard lock(mutex_);
  return calls_.size();
}

void OpenCalls::end_late_ones() {
  const auto now = std::chrono::steady_clock::now();
  const std::lock_guard lock(mutex_);  // a call that ends waits for it
  for (Call* const call : calls_) call->end_if_late(now);
}

// ---- one call

Call::Call(CallRoom& room, grpc::CallbackServerContext& context, const char* method, Access access)
    : room_(room),
      context_(context),
      head_{.method = method,
            .authorization = metadata_of(context, "authorization"),
            .request_id = request_id_of(metadata_of(context, "x-request-id")),
            .trace_id = trace_id_of(metadata_of(context, "traceparent")),
            .access = access} {
  context.AddInitialMetadata("x-request-id", head_.request_id);
  auto admitted = room.gate.admit(head_);
  if (admitted)
    tenant_ = *std::move(admitted);
  else
    refusal_ = std::move(admitted).error();
  head_.authorization.clear();
  room.open.add(*this);
}

void Call::over() {
  room_.open.remove(*this);
  try {
    room_.gate.answered({.method = head_.method,
                         .request_id = head_.request_id,
                         .trace_id = head_.trace_id,
                         .tenant = tenant_,
                         .status = status_,
                         .bytes_in = bytes_in_,
                         .bytes_out = bytes_out_,
                         .duration = Clock::now() - start_,
                         .is_complete = is_complete_});
  } catch (...) {  // a lost line is no reason to lose more
  }
}

std::string Call::peer() const {
  const std::string client = context_.peer();  // "ipv4:127.0.0.1:51220"
  return client.substr(0, client.rfind(':'));
}

grpc::Status Call::ok() {
  status_ = grpc::StatusCode::OK;
  return grpc::Status::OK;
}

grpc::Status Call::failed(const Error& error, const std::vector<GridCandidate>& candidates) {
  status_ = numbers_of(error.code).grpc_status;
  return status_of(error, room_.gate.retry_after_seconds(), candidates);
}

void Call::expect_client(std::chrono::milliseconds patience) {
  late_at_ = Clock::now() + patience;
}

void Call::end_if_late(Clock::time_point now) {
  if (now < late_at_.load()) return;
  client_came();
  context_.TryCancel();
}

Error too_busy() {
  return {ErrorCode::unavailable, "the server has too much to do; try again later"};
}

}  // namespace geosis::server::rpc
