#include "server/grpc/upload_call.h"

#include <atomic>
#include <memory>
#include <utility>
#include <vector>

#include <geosis/v1/volume.pb.h>

#include "server/app/uploads.h"
#include "server/grpc/message_codec.h"
#include "server/grpc/receiving.h"
#include "server/grpc/wire.h"

namespace geosis::server::rpc {
namespace {

class UploadCall final : public grpc::ServerReadReactor<grpc::ByteBuffer> {
 public:
  UploadCall(CallRoom& room, grpc::CallbackServerContext& context, grpc::ByteBuffer& response)
      : call_(room, context, "geosis.v1.VolumeService/UploadVolume", Access::write),
        context_(context),
        response_(response),
        receiver_(room, [this] { StartRead(&bytes_); }) {}

  /// Owned by gRPC until OnDone, and by the file's thread.
  void start(std::shared_ptr<UploadCall> self) {
    self_ = std::move(self);
    if (call_.refusal()) return Finish(call_.failed(*call_.refusal()));
    read();
  }

  void OnReadDone(bool ok) override {
    using Next = FileReceiver<v1::UploadVolumeRequest>::Next;
    call_.client_came();
    if (ok) call_.count_in(bytes_.Length());
    switch (receiver_.take(bytes_, ok)) {
      case Next::read_more:
        return receiver_.has_started() ? StartRead(&bytes_) : read();
      case Next::wait:
        return;
      case Next::start:
        if (!call_.room().uploads.start(call_.peer(), [self = self_] { self->run(); }))
          return Finish(call_.failed(too_busy()));
        if (receiver_.reads_on()) StartRead(&bytes_);
        return;
      case Next::refuse:
        return Finish(call_.failed(receiver_.refusal()));
    }
  }
  void OnCancel() override {
    has_left_ = true;
    receiver_.inbox().break_off({ErrorCode::cancelled, "the caller left"});
  }
  void OnDone() override {
    call_.over();
    self_.reset();
  }

 private:
  void read() {
    call_.expect_client(call_.room().patience);
    StartRead(&bytes_);
  }

  /// On the file's own thread.
  void run() {
    grpc::Status status = call_.failed({ErrorCode::internal, "an unexpected failure; nothing was stored"});
    try {
      status = receive();
    } catch (...) {
    }
    if (has_left_) call_.set_abandoned();
    receiver_.inbox().break_off({ErrorCode::cancelled, "the call is over"});  // nothing more is received
    Finish(std::move(status));
  }

  grpc::Status receive() {
    const Services services = call_.services();
    const auto memory = memory_to_import(services);
    if (!memory) return call_.failed(memory.error());
    std::vector<GridCandidate> candidates;
    const auto added = add(services, candidates);
    return added ? call_.ok() : call_.failed(added.error(), candidates);
  }

  Result<void> add(const Services& services, std::vector<GridCandidate>& candidates) {
    FileOptions& file = receiver_.file();
    const auto& stated = receiver_.options().options();
    file.upload.name = stated.name();
    // A stream that is cancelled ends like one that is complete; only after that it is known as cancelled.
    file.upload.confirm = [this]() -> Result<void> {
      if (has_left_ || context_.IsCancelled()) return Error{ErrorCode::cancelled, "the caller left"};
      return {};
    };
    WatchedImport progress(has_left_);
    const auto arriving = arriving_bytes(file.upload.import, file.bytes);
    if (arriving && !stated.respond_async()) {
      return answer(import_arriving(services, receiver_.inbox(), *arriving, file.upload, progress, candidates));
    }
    auto spooled = spool_body(services, receiver_.inbox(), file.bytes);
    if (!spooled) return std::move(spooled).error();
    if (!stated.respond_async()) {
      return answer(import_spooled(services, **spooled, file.upload, progress, candidates));
    }
    if (auto whole = file.upload.confirm(); !whole) return whole;
    file.upload.confirm = nullptr;  // it goes on without this call
    const auto begun = import_later(services, *std::move(spooled), file.upload);
    if (!begun) return begun.error();
    return answer(UploadResult{true, *begun});
  }

  Result<void> answer(const Result<UploadResult>& added) {
    if (!added) return added.error();
    v1::UploadVolumeResponse response;
    set_message(*response.mutable_volume(), added->document);
    response.set_is_new(added->is_new);
    response_ = serialized(response);
    call_.count_out(response_.Length());
    return {};
  }

  Call call_;
  grpc::CallbackServerContext& context_;
  grpc::ByteBuffer& response_;
  grpc::ByteBuffer bytes_;
  FileReceiver<v1::UploadVolumeRequest> receiver_;
  std::atomic<bool> has_left_{false};
  std::shared_ptr<UploadCall> self_;
};

}  // namespace

grpc::ServerReadReactor<grpc::ByteBuffer>* start_upload(CallRoom& room, grpc::CallbackServerContext* context,
                                                        grpc::ByteBuffer* response) {
  const auto call = std::make_shared<UploadCall>(room, *context, *response);
  call->start(call);
  return call.get();
}

}  // namespace geosis::server::rpc
