#include "server/grpc/calls/upload_call.h"

#include <memory>
#include <utility>
#include <vector>

#include <geosis/v1/volume.pb.h>

#include "server/app/volumes/uploads.h"
#include "server/grpc/calls/file_call.h"
#include "server/grpc/messages/message_codec.h"

namespace geosis::server::rpc {
namespace {

class UploadCall final : public FileCall<v1::UploadVolumeRequest> {
 public:
  UploadCall(CallRoom& room, grpc::CallbackServerContext& context, grpc::ByteBuffer& response)
      : FileCall(room, context, response, "geosis.v1.VolumeService/UploadVolume") {}

 private:
  Result<void> receive(const Services& services, std::vector<GridCandidate>& candidates) override {
    FileOptions& file = receiver().file();
    const auto& stated = receiver().options().options();
    file.upload.name = stated.name();
    file.upload.confirm = [this] { return confirm(); };
    WatchedImport progress(has_left());
    const auto arriving = arriving_bytes(file.upload.import, file.bytes);
    if (arriving && !stated.respond_async()) {
      return answer(import_arriving(services, receiver().inbox(), *arriving, file.upload, progress, candidates));
    }
    auto spooled = spool_body(services, receiver().inbox(), file.bytes);
    if (!spooled) return std::move(spooled).error();
    if (!stated.respond_async()) {
      return answer(import_spooled(services, **spooled, file.upload, progress, candidates));
    }
    if (auto whole = confirm(); !whole) return whole;
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
    set_answer(response);
    return {};
  }
};

}  // namespace

grpc::ServerReadReactor<grpc::ByteBuffer>* start_upload(CallRoom& room, grpc::CallbackServerContext* context,
                                                        grpc::ByteBuffer* response) {
  const auto call = std::make_shared<UploadCall>(room, *context, *response);
  call->start(call);
  return call.get();
}

}  // namespace geosis::server::rpc
