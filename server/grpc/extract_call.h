#pragma once

#include <geosis/v1/extraction.pb.h>
#include <grpcpp/support/server_callback.h>

#include "server/grpc/call.h"

namespace geosis::server::rpc {

/// Extract: a file in, the levels of its body out; nothing is kept.
grpc::ServerBidiReactor<v1::ExtractRequest, v1::LodChunk>* start_extract(CallRoom& room,
                                                                         grpc::CallbackServerContext* context);

}  // namespace geosis::server::rpc
