#include "server/grpc/calls/grid_upload_call.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <geosis/v1/grid.pb.h>

#include "server/app/derived/grid_calls.h"
#include "server/documents/node_grid_document.h"
#include "server/grpc/calls/file_call.h"
#include "server/grpc/messages/message_codec.h"

namespace geosis::server::rpc {

/// What FileReceiver asks of its options: positions have no import options.
static Result<FileOptions> file_options(const v1::UploadGridOptions& options, const CallRoom& room) {
  v1::UploadOptions file;
  file.set_sha256(options.sha256());
  if (options.has_bytes()) file.set_bytes(options.bytes());
  return file_options<v1::UploadOptions>(file, room);
}

namespace {

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

class GridUploadCall final : public FileCall<v1::UploadGridRequest> {
 public:
  GridUploadCall(CallRoom& room, grpc::CallbackServerContext& context, grpc::ByteBuffer& response)
      : FileCall(room, context, response, "geosis.v1.GridService/UploadGrid") {}

 private:
  /// The body of the stream, checked to its end.
  class WatchedBody final : public CheckedBody {
   public:
    explicit WatchedBody(GridUploadCall& call) : call_(call) {}
    Result<std::size_t> read(std::span<std::byte> into) override { return call_.receiver().inbox().read(into); }
    Result<void> check() override {
      if (auto same = call_.receiver().inbox().check(); !same) return same;
      return call_.confirm();
    }

   private:
    GridUploadCall& call_;
  };

  Result<void> receive(const Services& services, std::vector<GridCandidate>&) override {
    const v1::UploadGridOptions& options = receiver().options().options();
    const auto format = position_format(options);
    if (!format) return format.error();
    WatchedBody body(*this);
    WatchedImport progress(has_left());
    const auto added = upload_grid(services, options.volume(), body, receiver().file().bytes, *format, progress);
    if (!added) return added.error();
    v1::AddGridResponse response;
    set_message(*response.mutable_grid(), added->document);
    response.set_is_new(added->is_new);
    set_answer(response);
    return {};
  }
};

}  // namespace

grpc::ServerReadReactor<grpc::ByteBuffer>* start_grid_upload(CallRoom& room, grpc::CallbackServerContext* context,
                                                             grpc::ByteBuffer* response) {
  const auto call = std::make_shared<GridUploadCall>(room, *context, *response);
  call->start(call);
  return call.get();
}

}  // namespace geosis::server::rpc
