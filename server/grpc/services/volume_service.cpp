#include "server/grpc/services/volume_service.h"

#include <memory>
#include <string>

#include "server/app/volumes/volume_calls.h"
#include "server/grpc/calls/unary_call.h"
#include "server/grpc/calls/upload_call.h"
#include "server/grpc/messages/bounded.h"
#include "server/grpc/messages/message_codec.h"

namespace geosis::server::rpc {

grpc::ServerReadReactor<grpc::ByteBuffer>* VolumeServiceDoor::UploadVolume(grpc::CallbackServerContext* context,
                                                                           grpc::ByteBuffer* response) {
  return start_upload(room_, context, response);
}

grpc::ServerUnaryReactor* VolumeServiceDoor::GetVolume(grpc::CallbackServerContext* context,
                                                       const v1::GetVolumeRequest* request, v1::Volume* response) {
  const auto show = [=](Call& call) -> Result<void> {
    const auto document = show_volume(call.services(), request->id());
    if (!document) return document.error();
    set_message(*response, *document);
    return {};
  };
  return start_unary(room_, context, "geosis.v1.VolumeService/GetVolume", Access::read, {*request, *response},
                     {.answer = show});
}

grpc::ServerUnaryReactor* VolumeServiceDoor::ListVolumes(grpc::CallbackServerContext* context,
                                                         const v1::ListVolumesRequest* request,
                                                         v1::ListVolumesResponse* response) {
  const auto list = [=](Call& call) -> Result<void> {
    const auto size = bounded("page_size", request->page_size(), kDefaultPage, kLargestPage);
    if (!size) return size.error();
    const auto page = call.services().volumes.list(static_cast<std::size_t>(*size), request->page_token());
    if (!page) return page.error();
    set_message(*response, *page);
    return {};
  };
  return start_unary(room_, context, "geosis.v1.VolumeService/ListVolumes", Access::read, {*request, *response},
                     {.answer = list});
}

grpc::ServerUnaryReactor* VolumeServiceDoor::DeleteVolume(grpc::CallbackServerContext* context,
                                                          const v1::DeleteVolumeRequest* request,
                                                          google::protobuf::Empty* response) {
  const auto remove = [=](Call& call) { return remove_volume(call.services(), request->id()); };
  return start_unary(room_, context, "geosis.v1.VolumeService/DeleteVolume", Access::write, {*request, *response},
                     {.answer = remove, .lane = HandlerPool::Lane::writing});
}

grpc::ServerUnaryReactor* VolumeServiceDoor::GetHistogram(grpc::CallbackServerContext* context,
                                                          const v1::GetHistogramRequest* request,
                                                          v1::Histogram* response) {
  const auto counted = std::make_shared<Histogram>();
  const auto begin = [=](Call& call) -> Result<std::shared_ptr<Job>> {
    const auto bins = bounded("bins", request->bins(), kDefaultHistogramBins, kMaxHistogramBins);
    if (!bins) return bins.error();
    return begin_histogram(call.services(), request->id(), *bins, counted);
  };
  const auto answer = [=](Call&) -> Result<void> {
    response->mutable_edges()->Assign(counted->edges.begin(), counted->edges.end());
    response->mutable_counts()->Assign(counted->counts.begin(), counted->counts.end());
    response->set_missing(counted->missing);
    return {};
  };
  return start_unary(room_, context, "geosis.v1.VolumeService/GetHistogram", Access::read, {*request, *response},
                     {.begin = begin, .answer = answer, .owns_job = true});
}

}  // namespace geosis::server::rpc
