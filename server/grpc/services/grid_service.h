#pragma once

#include <geosis/v1/grid.grpc.pb.h>

#include "server/grpc/calls/call.h"

namespace geosis::server::rpc {

using AllGridCalls = v1::GridService;
/// All by callbacks; the one that takes a file raw.
using GridCalls = AllGridCalls::WithRawCallbackMethod_UploadGrid<
    AllGridCalls::WithCallbackMethod_CreateGrid<AllGridCalls::WithCallbackMethod_ListGrids<
        AllGridCalls::WithCallbackMethod_GetGrid<AllGridCalls::WithCallbackMethod_DeleteGrid<AllGridCalls::Service>>>>>;

/// geosis.v1.GridService over the use cases. Nothing of a call is done on gRPC's threads.
class GridServiceDoor final : public GridCalls {
 public:
  explicit GridServiceDoor(CallRoom& room) : room_(room) {}

  grpc::ServerReadReactor<grpc::ByteBuffer>* UploadGrid(grpc::CallbackServerContext* context,
                                                        grpc::ByteBuffer* response) override;
  grpc::ServerUnaryReactor* CreateGrid(grpc::CallbackServerContext* context, const v1::CreateGridRequest* request,
                                       v1::AddGridResponse* response) override;
  grpc::ServerUnaryReactor* ListGrids(grpc::CallbackServerContext* context, const v1::ListGridsRequest* request,
                                      v1::ListGridsResponse* response) override;
  grpc::ServerUnaryReactor* GetGrid(grpc::CallbackServerContext* context, const v1::GetGridRequest* request,
                                    v1::Grid* response) override;
  grpc::ServerUnaryReactor* DeleteGrid(grpc::CallbackServerContext* context, const v1::DeleteGridRequest* request,
                                       google::protobuf::Empty* response) override;

 private:
  CallRoom& room_;
};

}  // namespace geosis::server::rpc
