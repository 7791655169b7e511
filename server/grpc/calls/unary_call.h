#pragma once

#include <atomic>
#include <functional>
#include <memory>

#include <google/protobuf/message.h>
#include <grpcpp/support/server_callback.h>

#include "server/grpc/calls/call.h"
#include "server/grpc/calls/strand.h"
#include "server/jobs/job.h"

namespace geosis::server::rpc {

/// What a call with one request and one reply does. Both run on a handler's thread.
struct UnaryWork {
  /// Begins a job that the reply needs; null = none.
  std::function<Result<std::shared_ptr<Job>>(Call&)> begin = {};
  /// Fills the reply, once that job is done.
  std::function<Result<void>(Call&)> answer;
  /// Nobody else wants the job: it ends with the call.
  bool owns_job = false;
  HandlerPool::Lane lane = HandlerPool::Lane::reading;
};

/// The call's messages; their sizes are counted.
struct UnaryMessages {
  const google::protobuf::Message& request;
  const google::protobuf::Message& response;
};

grpc::ServerUnaryReactor* start_unary(CallRoom& room, grpc::CallbackServerContext* context, const char* method,
                                      Access access, UnaryMessages messages, UnaryWork work);

}  // namespace geosis::server::rpc
