#include "server/grpc/services/grid_service.h"

#include <memory>
#include <string>

#include "server/app/derived/grid_calls.h"
#include "server/app/volumes/volume_calls.h"
#include "server/grpc/calls/grid_upload_call.h"
#include "server/grpc/calls/unary_call.h"
#include "server/grpc/messages/bounded.h"
#include "server/grpc/messages/message_codec.h"

namespace geosis::server::rpc {

grpc::ServerReadReactor<grpc::ByteBuffer>* GridServiceDoor::UploadGrid(grpc::CallbackServerContext* context,
                                                                       grpc::ByteBuffer* response) {
  return start_grid_upload(room_, context, response);
}

grpc::ServerUnaryReactor* GridServiceDoor::CreateGrid(grpc::CallbackServerContext* context,
                                                      const v1::CreateGridRequest* request,
                                                      v1::AddGridResponse* response) {
  const auto added = std::make_shared<AddedGrid>();
  const auto begin = [=](Call& call) -> Result<std::shared_ptr<Job>> {
    const auto coordinates = document_of(request->coordinates());
    if (!coordinates) return coordinates.error();
    return begin_grid(call.services(), request->volume(), *coordinates, added);
  };
  const auto answer = [=](Call&) -> Result<void> {
    set_message(*response->mutable_grid(), added->document);
    response->set_is_new(added->is_new);
    return {};
  };
  return start_unary(room_, context, "geosis.v1.GridService/CreateGrid", Access::write, {*request, *response},
                     {.begin = begin, .answer = answer, .owns_job = true, .lane = HandlerPool::Lane::writing});
}

grpc::ServerUnaryReactor* GridServiceDoor::ListGrids(grpc::CallbackServerContext* context,
                                                     const v1::ListGridsRequest* request,
                                                     v1::ListGridsResponse* response) {
  const auto list = [=](Call& call) -> Result<void> {
    const auto size = bounded("page_size", request->page_size(), kDefaultPage, kLargestPage);
    if (!size) return size.error();
    const auto page =
        list_grids(call.services(), request->volume(), static_cast<std::size_t>(*size), request->page_token());
    if (!page) return page.error();
    set_message(*response, *page);
    return {};
  };
  return start_unary(room_, context, "geosis.v1.GridService/ListGrids", Access::read, {*request, *response},
                     {.answer = list});
}

grpc::ServerUnaryReactor* GridServiceDoor::GetGrid(grpc::CallbackServerContext* context,
                                                   const v1::GetGridRequest* request, v1::Grid* response) {
  const auto show = [=](Call& call) -> Result<void> {
    const auto document = show_grid(call.services(), request->volume(), request->id());
    if (!document) return document.error();
    set_message(*response, *document);
    return {};
  };
  return start_unary(room_, context, "geosis.v1.GridService/GetGrid", Access::read, {*request, *response},
                     {.answer = show});
}

grpc::ServerUnaryReactor* GridServiceDoor::DeleteGrid(grpc::CallbackServerContext* context,
                                                      const v1::DeleteGridRequest* request,
                                                      google::protobuf::Empty* response) {
  const auto remove = [=](Call& call) { return remove_grid(call.services(), request->volume(), request->id()); };
  return start_unary(room_, context, "geosis.v1.GridService/DeleteGrid", Access::write, {*request, *response},
                     {.answer = remove, .lane = HandlerPool::Lane::writing});
}

}  // namespace geosis::server::rpc
