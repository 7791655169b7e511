#pragma once

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include "server/grpc/calls/call.h"

namespace geosis::server::rpc {

/// Extract: a file in, the levels of its body out; nothing is kept.
grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* start_extract(CallRoom& room,
                                                                           grpc::CallbackServerContext* context);

}  // namespace geosis::server::rpc
