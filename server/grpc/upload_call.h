#pragma once

#include <geosis/v1/volume.pb.h>
#include <grpcpp/support/server_callback.h>

#include "server/grpc/call.h"

namespace geosis::server::rpc {

/// UploadVolume: a file in, its volume out.
grpc::ServerReadReactor<v1::UploadVolumeRequest>* start_upload(CallRoom& room, grpc::CallbackServerContext* context,
                                                               v1::UploadVolumeResponse* response);

}  // namespace geosis::server::rpc
