#pragma once

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include "server/grpc/calls/call.h"

namespace geosis::server::rpc {

/// UploadVolume: a file in, its volume out. Messages as they are on the wire: only_field() says why.
grpc::ServerReadReactor<grpc::ByteBuffer>* start_upload(CallRoom& room, grpc::CallbackServerContext* context,
                                                        grpc::ByteBuffer* response);

}  // namespace geosis::server::rpc
