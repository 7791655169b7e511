#pragma once

#include <geosis/v1/volume.grpc.pb.h>

#include "server/grpc/calls/call.h"

namespace geosis::server::rpc {

using AllVolumeCalls = v1::VolumeService;
/// All by callbacks; the one that takes a file raw.
using VolumeCalls = AllVolumeCalls::WithRawCallbackMethod_UploadVolume<AllVolumeCalls::WithCallbackMethod_GetVolume<
    AllVolumeCalls::WithCallbackMethod_ListVolumes<AllVolumeCalls::WithCallbackMethod_DeleteVolume<
        AllVolumeCalls::WithCallbackMethod_GetHistogram<AllVolumeCalls::Service>>>>>;

/// geosis.v1.VolumeService over the use cases. Nothing of a call is done on gRPC's threads.
class VolumeServiceDoor final : public VolumeCalls {
 public:
  explicit VolumeServiceDoor(CallRoom& room) : room_(room) {}

  grpc::ServerReadReactor<grpc::ByteBuffer>* UploadVolume(grpc::CallbackServerContext* context,
                                                          grpc::ByteBuffer* response) override;
  grpc::ServerUnaryReactor* GetVolume(grpc::CallbackServerContext* context, const v1::GetVolumeRequest* request,
                                      v1::Volume* response) override;
  grpc::ServerUnaryReactor* ListVolumes(grpc::CallbackServerContext* context, const v1::ListVolumesRequest* request,
                                        v1::ListVolumesResponse* response) override;
  grpc::ServerUnaryReactor* DeleteVolume(grpc::CallbackServerContext* context, const v1::DeleteVolumeRequest* request,
                                         google::protobuf::Empty* response) override;
  grpc::ServerUnaryReactor* GetHistogram(grpc::CallbackServerContext* context, const v1::GetHistogramRequest* request,
                                         v1::Histogram* response) override;

 private:
  CallRoom& room_;
};

}  // namespace geosis::server::rpc
