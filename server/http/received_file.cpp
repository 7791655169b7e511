#include "server/http/received_file.h"

#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include "server/http/content_digest.h"
#include "server/http/descriptor.h"
#include "server/http/form_reader.h"
#include "server/http/parameters.h"

namespace geosis::server::http {
namespace {

constexpr std::size_t kPiece = 1 << 18;

Result<void> write_all(int descriptor, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0 && (errno == ENOSPC || errno == EDQUOT))
      return Error{ErrorCode::no_space, "the store's disk is full"};
    if (written < 0) return Error{ErrorCode::unavailable, "writing the received file failed"};
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return {};
}

/// Before the body is read: a file that cannot fit is not even begun.
Result<void> check_space(const StagedFile& file, std::optional<std::uint64_t> bytes) {
  std::error_code unknown;
  const auto space = std::filesystem::space(file.path().parent_path(), unknown);
  if (unknown || !bytes || *bytes <= space.available) return {};
  return Error{ErrorCode::no_space, "the body has " + std::to_string(*bytes) + " bytes; the store's disk has " +
                                        std::to_string(space.available) + " left"};
}

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
  auto staged = store.stage();
  if (!staged) return std::move(staged).error();
  ReceivedFile received{*std::move(staged), {}, {}};
  if (auto fits = check_space(*received.file, request.content_length); !fits) return std::move(fits).error();
  const Descriptor descriptor(::open(received.file->path().c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
  if (!descriptor.is_open()) return Error{ErrorCode::unavailable, "the store's staging cannot be written"};
  const FileSink sink = [&](std::span<const std::byte> bytes) { return write_all(descriptor.number(), bytes); };

  const auto boundary = form_boundary(header(request, "content-type"));
  if (!boundary) {
    if (auto copied = copy_body(body, sink); !copied) return std::move(copied).error();
    if (auto same = body.check(); !same) return std::move(same).error();
    return received;
  }
  auto fields = read_form(body, *boundary, sink);
  if (!fields) return std::move(fields).error();
  if (!fields->has_file) return Error{ErrorCode::malformed_input, "form: there is no part named file"};
  if (auto same = body.check(); !same) return std::move(same).error();
  received.name = std::move(fields->file_name);
  received.fields = std::move(fields->text);
  return received;
}

}  // namespace geosis::server::http
