#include "server/grpc/calls/extract_call.h"

#include <atomic>
#include <memory>
#include <utility>
#include <vector>

#include "server/app/volumes/uploads.h"
#include "server/documents/request.h"
#include "server/grpc/calls/receiving.h"
#include "server/grpc/calls/streaming.h"
#include "server/grpc/messages/message_codec.h"

namespace geosis::server::rpc {
namespace {

using Streaming = StreamingCall<grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>, grpc::ByteBuffer>;

/// First the file comes in, on a thread of its own, then the levels go out.
class ExtractCall final : public Streaming {
 public:
  ExtractCall(CallRoom& room, grpc::CallbackServerContext& context)
      : Streaming(room, context, "geosis.v1.ExtractionService/Extract", Access::write),
        receiver_(room, [this] { StartRead(&bytes_); }) {}

  void OnReadDone(bool ok) override {
    using Next = FileReceiver<v1::ExtractRequest>::Next;
    call().client_came();
    if (ok) call().count_in(bytes_.Length());
    switch (receiver_.take(bytes_, ok)) {
      case Next::read_more:
        return receiver_.has_started() ? StartRead(&bytes_) : read();
      case Next::wait:
        return;
      case Next::start: {
        const auto self = std::static_pointer_cast<ExtractCall>(shared_from_this());
        if (!call().room().uploads.start(call().peer(), [self] { self->run(); }))
          return set_end(call().failed(too_busy()));
        if (receiver_.reads_on()) StartRead(&bytes_);
        return;
      }
      case Next::refuse:
        return set_end(call().failed(receiver_.refusal()));
    }
  }

 private:
  Result<std::unique_ptr<Source>> open_source() override {
    read();
    return std::unique_ptr<Source>();
  }
  void on_left() override {
    has_left_ = true;
    receiver_.inbox().break_off({ErrorCode::cancelled, "the caller left"});
  }
  void read() {
    call().expect_client(call().room().patience);
    StartRead(&bytes_);
  }

  /// On the file's own thread.
  void run() {
    std::vector<GridCandidate> candidates;
    Result<std::shared_ptr<Extraction>> extraction = Error{ErrorCode::internal, "an unexpected failure"};
    try {
      extraction = receive(candidates);
    } catch (...) {
    }
    receiver_.inbox().break_off({ErrorCode::cancelled, "the file is read"});  // nothing more is received
    if (!extraction) return set_end(call().failed(extraction.error(), candidates));
    set_source(lod_source(*extraction, {.abandoned = abandonment(*extraction)}));
  }

  Result<std::shared_ptr<Extraction>> receive(std::vector<GridCandidate>& candidates) {
    const auto request = document_of(receiver_.options().options().request());
    if (!request) return request.error();
    if (const auto parsed = parse_request(*request); !parsed) return parsed.error();
    const Services services = call().services();
    const auto memory = memory_to_import(services);
    if (!memory) return memory.error();
    const auto file = spool_body(services, receiver_.inbox(), receiver_.file().bytes);
    if (!file) return file.error();
    WatchedImport progress(has_left_);
    return extract_spooled(services, **file, receiver_.file().upload, *request, progress, candidates);
  }

  grpc::ByteBuffer bytes_;
  FileReceiver<v1::ExtractRequest> receiver_;
  std::atomic<bool> has_left_{false};
};

}  // namespace

grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* start_extract(CallRoom& room,
                                                                           grpc::CallbackServerContext* context) {
  const auto call = std::make_shared<ExtractCall>(room, *context);
  call->start(call);
  return call.get();
}

}  // namespace geosis::server::rpc
