#pragma once

#include <geosis/v1/extraction.grpc.pb.h>

#include "server/grpc/call.h"

namespace geosis::server::rpc {

/// geosis.v1.ExtractionService over the use cases. Nothing of a call is done on gRPC's threads.
class ExtractionServiceDoor final : public v1::ExtractionService::CallbackService {
 public:
  explicit ExtractionServiceDoor(CallRoom& room) : room_(room) {}

  grpc::ServerUnaryReactor* CreateExtraction(grpc::CallbackServerContext* context,
                                             const v1::CreateExtractionRequest* request,
                                             v1::Extraction* response) override;
  grpc::ServerUnaryReactor* GetExtraction(grpc::CallbackServerContext* context, const v1::GetExtractionRequest* request,
                                          v1::Extraction* response) override;
  grpc::ServerWriteReactor<v1::ExtractionEvent>* WatchExtraction(grpc::CallbackServerContext* context,
                                                                 const v1::WatchExtractionRequest* request) override;
  grpc::ServerUnaryReactor* CancelExtraction(grpc::CallbackServerContext* context,
                                             const v1::CancelExtractionRequest* request,
                                             google::protobuf::Empty* response) override;
  grpc::ServerWriteReactor<v1::LodChunk>* StreamLods(grpc::CallbackServerContext* context,
                                                     const v1::StreamLodsRequest* request) override;
  grpc::ServerUnaryReactor* ListBodies(grpc::CallbackServerContext* context, const v1::ListBodiesRequest* request,
                                       v1::ListBodiesResponse* response) override;
  grpc::ServerBidiReactor<v1::ExtractRequest, v1::LodChunk>* Extract(grpc::CallbackServerContext* context) override;

 private:
  CallRoom& room_;
};

}  // namespace geosis::server::rpc
