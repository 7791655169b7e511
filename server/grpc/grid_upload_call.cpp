#include "server/grpc/grid_upload_call.h"

#include <atomic>
#include <memory>
#include <string>
#include <utility>

#include <geosis/v1/grid.pb.h>

#include "server/app/grid_calls.h"
#include "server/documents/node_grid_document.h"
#include "server/grpc/message_codec.h"
#include "server/grpc/receiving.h"
#include "server/grpc/wire.h"

namespace geosis::server::rpc {

/// What FileReceiver asks of its options: positions have no import options.
static Result<FileOptions> file_options(const v1::UploadGridOptions& options, const CallRoom& room) {
  v1::UploadOptions file;
  file.set_sha256(options.sha256());
  if (options.has_bytes()) file.set_bytes(options.bytes());
  return file_options<v1::UploadOptions>(file, room);
}

namespace {

using Receiver = FileReceiver<v1::UploadGridRequest>;

Result<PositionFormat> position_format(const v1::UploadGridOptions& options) {
  PositionFormat format;
  for (const auto& [name, text] : {std::pair<const char*, const std::string*>{"kind", &options.kind()},
                                   {"dtype", &options.dtype()},
                                   {"byte_order", &options.byte_order()}}) {
    if (text->empty()) continue;
    if (auto set = set_position_option(format, name, *text); !set) {
      return Error{set.error().code, std::string("/") + set.error().message};
    }
  }
  return format;
}

class GridUploadCall final : public grpc::ServerReadReactor<grpc::ByteBuffer> {
 public:
  GridUploadCall(CallRoom& room, grpc::CallbackServerContext& context, grpc::ByteBuffer& response)
      : call_(room, context, "geosis.v1.GridService/UploadGrid", Access::write),
        context_(context),
        response_(response),
        receiver_(room, [this] { StartRead(&bytes_); }) {}

  /// Owned by gRPC until OnDone, and by the file's thread.
  void start(std::shared_ptr<GridUploadCall> self) {
    self_ = std::move(self);
    if (call_.refusal()) return Finish(call_.failed(*call_.refusal()));
    read();
  }

  void OnReadDone(bool ok) override {
    call_.client_came();
    if (ok) call_.count_in(bytes_.Length());
    switch (receiver_.take(bytes_, ok)) {
      case Receiver::Next::read_more:
        return receiver_.has_started() ? StartRead(&bytes_) : read();
      case Receiver::Next::wait:
        return;
      case Receiver::Next::start:
        if (!call_.room().uploads.start(call_.peer(), [self = self_] { self->run(); }))
          return Finish(call_.failed(too_busy()));
        if (receiver_.reads_on()) StartRead(&bytes_);
        return;
      case Receiver::Next::refuse:
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
  /// The body of a stream; one that is cancelled ends like one that is complete, and only after that it is known.
  class WatchedBody final : public CheckedBody {
   public:
    explicit WatchedBody(GridUploadCall& call) : call_(call) {}
    Result<std::size_t> read(std::span<std::byte> into) override { return call_.receiver_.inbox().read(into); }
    Result<void> check() override {
      if (auto same = call_.receiver_.inbox().check(); !same) return same;
      if (!call_.has_left_ && !call_.context_.IsCancelled()) return {};
      return Error{ErrorCode::cancelled, "the caller left"};
    }

   private:
    GridUploadCall& call_;
  };

  void read() {
    call_.expect_client(call_.room().patience);
    StartRead(&bytes_);
  }

  /// On the file's own thread.
  void run() {
    grpc::Status status = call_.failed({ErrorCode::internal, "an unexpected failure; nothing was stored"});
    try {
      const auto added = receive();
      status = added ? call_.ok() : call_.failed(added.error());
    } catch (...) {
    }
    if (has_left_) call_.set_abandoned();
    receiver_.inbox().break_off({ErrorCode::cancelled, "the call is over"});  // nothing more is received
    Finish(std::move(status));
  }

  Result<void> receive() {
    const Services services = call_.services();
    const auto memory = memory_to_import(services);
    if (!memory) return memory.error();
    const v1::UploadGridOptions& options = receiver_.options().options();
    const auto format = position_format(options);
    if (!format) return format.error();
    WatchedBody body(*this);
    WatchedImport progress(has_left_);
    const auto added = upload_grid(services, options.volume(), body, receiver_.file().bytes, *format, progress);
    if (!added) return added.error();
    v1::AddGridResponse response;
    set_message(*response.mutable_grid(), added->document);
    response.set_is_new(added->is_new);
    response_ = serialized(response);
    call_.count_out(response_.Length());
    return {};
  }

  Call call_;
  grpc::CallbackServerContext& context_;
  grpc::ByteBuffer& response_;
  grpc::ByteBuffer bytes_;
  Receiver receiver_;
  std::atomic<bool> has_left_{false};
  std::shared_ptr<GridUploadCall> self_;
};

}  // namespace

grpc::ServerReadReactor<grpc::ByteBuffer>* start_grid_upload(CallRoom& room, grpc::CallbackServerContext* context,
                                                             grpc::ByteBuffer* response) {
  const auto call = std::make_shared<GridUploadCall>(room, *context, *response);
  call->start(call);
  return call.get();
}

}  // namespace geosis::server::rpc
