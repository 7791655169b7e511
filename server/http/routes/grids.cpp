#include <array>
#include <string>
#include <utility>

#include "server/app/derived/grid_calls.h"
#include "server/app/volumes/volume_calls.h"
#include "server/documents/node_grid_document.h"
#include "server/http/routes/routes.h"
#include "server/http/routing/error_reply.h"
#include "server/http/routing/json_reply.h"
#include "server/http/routing/parameters.h"
#include "server/http/wire/content_digest.h"

namespace geosis::server::http {
namespace {

constexpr std::size_t kMostJson = 1 << 16;

Reply added_reply(const Result<AddedGrid>& added) {
  if (!added) return error_reply(added.error());
  Reply reply = json_reply(added->is_new ? 201 : 200, added->document);
  reply.headers.emplace_back("Location", added->document.at("links").at("self").get<std::string>());
  return reply;
}

Result<PositionFormat> position_format(const Request& request) {
  PositionFormat format;
  for (const auto& [name, text] : request.query) {
    if (auto set = set_position_option(format, name, text); !set) {
      return Error{set.error().code, "parameter " + set.error().message};
    }
  }
  return format;
}

/// A body that is a document.
Result<Json> read_json(BodyReader& body) {
  std::string text(kMostJson + 1, '\0');
  std::size_t length = 0;
  while (length < text.size()) {
    const auto count = body.read(std::as_writable_bytes(std::span(text).subspan(length)));
    if (!count) return count.error();
    if (*count == 0) break;
    length += *count;
  }
  if (length > kMostJson) return Error{ErrorCode::limit_exceeded, "request body: a document has at most 64 KiB"};
  text.resize(length);
  auto document = parse_json(text);
  if (!document) return Error{ErrorCode::invalid_argument, "request body: " + document.error().message};
  return document;
}

Reply add_from_volumes(const Services& services, const Request& request, CheckedBody& body) {
  if (auto known = only_parameters(request, {}); !known) return error_reply(known.error());
  const auto coordinates = read_json(body);
  if (!coordinates) return error_reply(coordinates.error());
  if (auto same = body.check(); !same) return error_reply(same.error());
  NoProgress unwatched;
  return added_reply(create_grid(services, request.captures[0], *coordinates, unwatched));
}

Reply add(const Services& services, const Request& request, BodyReader& wire) {
  const auto memory = memory_to_import(services);
  if (!memory) return error_reply(memory.error());
  auto stated = stated_digests(request);
  if (!stated) return error_reply(stated.error());
  DigestedBody body(wire, *std::move(stated));
  if (header(request, "content-type").starts_with("application/json")) {
    return add_from_volumes(services, request, body);
  }
  const auto format = position_format(request);
  if (!format) return error_reply(format.error());
  NoProgress unwatched;
  return added_reply(upload_grid(services, request.captures[0], body, request.content_length, *format, unwatched));
}

Reply list(const Services& services, const Request& request) {
  if (auto known = only_parameters(request, {"page_size", "page_token"}); !known) return error_reply(known.error());
  const auto page_size = whole_parameter(request, "page_size", kDefaultPage, 1, kLargestPage);
  if (!page_size) return error_reply(page_size.error());
  const auto page = list_grids(services, request.captures[0], static_cast<std::size_t>(*page_size),
                               parameter(request, "page_token").value_or(""));
  return page ? json_reply(200, *page) : error_reply(page.error());
}

Reply get(const Services& services, const Request& request) {
  const auto document = show_grid(services, request.captures[0], request.captures[1]);
  return document ? json_reply(200, *document) : error_reply(document.error());
}

Reply remove(const Services& services, const Request& request) {
  if (auto removed = remove_grid(services, request.captures[0], request.captures[1]); !removed) {
    return error_reply(removed.error());
  }
  Reply reply;
  reply.status = 204;
  return reply;
}

}  // namespace

void add_grid_routes(Router& router, const ServicesOf& services) {
  const auto with = [services](auto handler) {
    return [=](const Request& request) { return handler(services(request), request); };
  };
  router.upload("/v1/volumes/([^/]+)/grids",
                [services](const Request& request, BodyReader& body) { return add(services(request), request, body); });
  router.get("/v1/volumes/([^/]+)/grids", with(list));
  router.get("/v1/volumes/([^/]+)/grids/([^/]+)", with(get));
  router.remove("/v1/volumes/([^/]+)/grids/([^/]+)", with(remove));
}

}  // namespace geosis::server::http
