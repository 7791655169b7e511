#include "server/grpc/services/extraction_service.h"

#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "server/grpc/calls/extract_call.h"
#include "server/grpc/calls/streaming.h"
#include "server/grpc/calls/unary_call.h"
#include "server/grpc/messages/message_codec.h"
#include "server/grpc/messages/wire.h"

namespace geosis::server::rpc {
namespace {

/// A call that streams messages of an extraction's.
template <class Message>
class ExtractionStream final : public StreamingCall<grpc::ServerWriteReactor<Message>, Message> {
 public:
  using Source = MessageSource<Message>;
  using Open = std::function<Result<std::unique_ptr<Source>>(const Services&)>;

  ExtractionStream(CallRoom& room, grpc::CallbackServerContext& context, const char* method, Open open)
      : StreamingCall<grpc::ServerWriteReactor<Message>, Message>(room, context, method, Access::read),
        open_(std::move(open)) {}

 private:
  Result<std::unique_ptr<Source>> open_source() override { return open_(this->call().services()); }

  const Open open_;
};

template <class Message>
grpc::ServerWriteReactor<Message>* start_stream(CallRoom& room, grpc::CallbackServerContext* context,
                                                const char* method, typename ExtractionStream<Message>::Open open) {
  const auto call = std::make_shared<ExtractionStream<Message>>(room, *context, method, std::move(open));
  call->start(call);
  return call.get();
}

Priority priority_of(const v1::CreateExtractionRequest& request) {
  return request.priority() == v1::PRIORITY_BATCH ? Priority::batch : Priority::interactive;
}

}  // namespace

grpc::ServerUnaryReactor* ExtractionServiceDoor::CreateExtraction(grpc::CallbackServerContext* context,
                                                                  const v1::CreateExtractionRequest* request,
                                                                  v1::Extraction* response) {
  const auto create = [=](Call& call) -> Result<void> {
    const auto wanted = document_of(request->request());
    if (!wanted) return wanted.error();
    const auto extraction =
        call.services().extractions.create(request->volume(), *wanted, priority_of(*request), call.request_id());
    if (!extraction) return extraction.error();
    set_message(*response, resource_document(**extraction));
    return {};
  };
  return start_unary(room_, context, "geosis.v1.ExtractionService/CreateExtraction", Access::read,
                     {*request, *response}, {.answer = create, .lane = HandlerPool::Lane::writing});
}

grpc::ServerUnaryReactor* ExtractionServiceDoor::GetExtraction(grpc::CallbackServerContext* context,
                                                               const v1::GetExtractionRequest* request,
                                                               v1::Extraction* response) {
  const auto show = [=](Call& call) -> Result<void> {
    const auto extraction = call.services().extractions.find(request->id());
    if (!extraction) return extraction.error();
    set_message(*response, resource_document(**extraction));
    return {};
  };
  return start_unary(room_, context, "geosis.v1.ExtractionService/GetExtraction", Access::read, {*request, *response},
                     {.answer = show});
}

grpc::ServerWriteReactor<v1::ExtractionEvent>* ExtractionServiceDoor::WatchExtraction(
    grpc::CallbackServerContext* context, const v1::WatchExtractionRequest* request) {
  using Source = MessageSource<v1::ExtractionEvent>;
  const auto open = [=](const Services& services) -> Result<std::unique_ptr<Source>> {
    auto extraction = services.extractions.find(request->id());
    if (!extraction) return std::move(extraction).error();
    return event_source(*std::move(extraction), request->after_event());
  };
  return start_stream<v1::ExtractionEvent>(room_, context, "geosis.v1.ExtractionService/WatchExtraction", open);
}

grpc::ServerUnaryReactor* ExtractionServiceDoor::CancelExtraction(grpc::CallbackServerContext* context,
                                                                  const v1::CancelExtractionRequest* request,
                                                                  google::protobuf::Empty* response) {
  const auto cancel = [=](Call& call) {
    Extractions& extractions = call.services().extractions;
    return request->purge() ? extractions.purge(request->id()) : extractions.withdraw(request->id());
  };
  return start_unary(room_, context, "geosis.v1.ExtractionService/CancelExtraction",
                     request->purge() ? Access::write : Access::read, {*request, *response},
                     {.answer = cancel, .lane = HandlerPool::Lane::writing});
}

grpc::ServerWriteReactor<grpc::ByteBuffer>* ExtractionServiceDoor::StreamLods(grpc::CallbackServerContext* context,
                                                                              const grpc::ByteBuffer* bytes) {
  using Source = MessageSource<grpc::ByteBuffer>;
  const auto open = [=](const Services& services) -> Result<std::unique_ptr<Source>> {
    v1::StreamLodsRequest request;
    if (!parse(*bytes, request)) return Error{ErrorCode::invalid_argument, "the request is no StreamLodsRequest"};
    LevelFeed::Options options;
    if (request.has_from_level()) options.from_level = request.from_level();
    if (options.from_level.value_or(0) < 0) {
      return Error{ErrorCode::invalid_argument,
                   "/from_level: " + std::to_string(*options.from_level) + "; expected a level, from 0 on"};
    }
    auto extraction = services.extractions.find(request.id());
    if (!extraction) return std::move(extraction).error();
    return lod_source(*std::move(extraction), std::move(options));
  };
  return start_stream<grpc::ByteBuffer>(room_, context, "geosis.v1.ExtractionService/StreamLods", open);
}

grpc::ServerUnaryReactor* ExtractionServiceDoor::ListBodies(grpc::CallbackServerContext* context,
                                                            const v1::ListBodiesRequest* request,
                                                            v1::ListBodiesResponse* response) {
  const auto begin = [=](Call& call) -> Result<std::shared_ptr<Job>> {
    Extractions& extractions = call.services().extractions;
    if (extractions.are_bodies_made(request->id())) return std::shared_ptr<Job>();
    return extractions.begin_bodies(request->id());
  };
  const auto list = [=](Call& call) -> Result<void> {
    auto file = call.services().extractions.bodies(request->id());
    if (!file) return std::move(file).error();
    const auto text = read_whole(*file);
    if (!text) return text.error();
    const auto document = parse_json(*text);
    if (!document) return document.error();
    set_message(*response, *document);
    return {};
  };
  return start_unary(room_, context, "geosis.v1.ExtractionService/ListBodies", Access::read, {*request, *response},
                     {.begin = begin, .answer = list});
}

grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* ExtractionServiceDoor::Extract(
    grpc::CallbackServerContext* context) {
  return start_extract(room_, context);
}

}  // namespace geosis::server::rpc
