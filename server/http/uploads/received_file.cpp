#include "server/http/uploads/received_file.h"

#include <string>
#include <utility>
#include <vector>

#include "server/http/routing/parameters.h"
#include "server/http/wire/content_digest.h"
#include "server/http/wire/form_reader.h"
#include "server/store/spool.h"

namespace geosis::server::http {
namespace {

constexpr std::size_t kPiece = 1 << 18;

Result<void> copy_body(BodyReader& body, const FileSink& sink) {
  std::vector<std::byte> piece(kPiece);
  for (;;) {
    const auto count = body.read(piece);
    if (!count) return count.error();
    if (*count == 0) return {};
    if (auto taken = sink(std::span(piece).first(*count)); !taken) return taken;
  }
}

}  // namespace

Result<ReceivedFile> receive_file(const Request& request, BodyReader& wire, BlobStore& store) {
  auto stated = stated_digests(request);
  if (!stated) return std::move(stated).error();
  DigestedBody body(wire, *std::move(stated));
  auto spool = Spool::open(store, request.content_length);
  if (!spool) return std::move(spool).error();
  const FileSink sink = [&](std::span<const std::byte> bytes) { return spool->write(bytes); };
  ReceivedFile received;

  const auto boundary = form_boundary(header(request, "content-type"));
  if (!boundary) {
    if (auto copied = copy_body(body, sink); !copied) return std::move(copied).error();
    if (auto same = body.check(); !same) return std::move(same).error();
    received.file = spool->take();
    return received;
  }
  auto fields = read_form(body, *boundary, sink);
  if (!fields) return std::move(fields).error();
  if (!fields->has_file) return Error{ErrorCode::malformed_input, "form: there is no part named file"};
  if (auto same = body.check(); !same) return std::move(same).error();
  received.file = spool->take();
  received.name = std::move(fields->file_name);
  received.fields = std::move(fields->text);
  return received;
}

}  // namespace geosis::server::http
