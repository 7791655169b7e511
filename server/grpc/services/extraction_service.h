#pragma once

#include <geosis/v1/extraction.grpc.pb.h>

#include "server/grpc/calls/call.h"

namespace geosis::server::rpc {

using AllExtractionCalls = v1::ExtractionService;
/// All by callbacks; those that stream levels raw.
using ExtractionCalls =
    AllExtractionCalls::WithCallbackMethod_CreateExtraction<AllExtractionCalls::WithCallbackMethod_GetExtraction<
        AllExtractionCalls::WithCallbackMethod_WatchExtraction<AllExtractionCalls::WithCallbackMethod_CancelExtraction<
            AllExtractionCalls::WithRawCallbackMethod_StreamLods<AllExtractionCalls::WithCallbackMethod_ListBodies<
                AllExtractionCalls::WithRawCallbackMethod_Extract<AllExtractionCalls::Service>>>>>>>;

/// geosis.v1.ExtractionService over the use cases. Nothing of a call is done on gRPC's threads.
///
/// Calls that stream levels write bytes as they are on the wire: lod_source() says why.
class ExtractionServiceDoor final : public ExtractionCalls {
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
  grpc::ServerWriteReactor<grpc::ByteBuffer>* StreamLods(grpc::CallbackServerContext* context,
                                                         const grpc::ByteBuffer* request) override;
  grpc::ServerUnaryReactor* ListBodies(grpc::CallbackServerContext* context, const v1::ListBodiesRequest* request,
                                       v1::ListBodiesResponse* response) override;
  grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* Extract(grpc::CallbackServerContext* context) override;

 private:
  CallRoom& room_;
};

}  // namespace geosis::server::rpc
