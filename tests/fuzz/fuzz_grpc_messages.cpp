// Any bytes as the messages that the gRPC door is sent. The first byte chooses which: the stream of an upload or of a
// one-shot call, whose messages have their lengths before them, or a request for an extraction. Each is parsed from one
// slice and from slices of some bytes, as they come off the wire, with the same outcome.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <geosis/v1/extraction.pb.h>
#include <geosis/v1/volume.pb.h>
#include <grpcpp/support/byte_buffer.h>

#include "server/documents/json_text.h"
#include "server/documents/request.h"
#include "server/grpc/calls/receiving.h"
#include "server/grpc/messages/message_codec.h"
#include "server/grpc/messages/wire.h"

namespace {

using namespace geosis::server;
using namespace geosis::server::rpc;
using geosis::Result;

void expect(bool law) {
  if (!law) std::abort();
}

class NoGate final : public CallGate {
 public:
  Result<std::string> admit(const CallHead&) override { return std::string("default"); }
  void answered(const AnsweredCall&) override {}
  int retry_after_seconds() const override { return 1; }
};

CallRoom& room() {
  static NoGate gate;
  static HandlerPool pool(1, 1);
  static Slots slots(1);
  static UploadThreads uploads(slots);
  static CallRoom room{.services_of = {},
                       .gate = gate,
                       .pool = pool,
                       .uploads = uploads,
                       .upload_bytes = 1 << 20,
                       .upload_bytes_per_second = 0,
                       .patience = std::chrono::milliseconds(1000),
                       .reader_patience = std::chrono::milliseconds(1000)};
  return room;
}

grpc::ByteBuffer buffer_of(std::string_view bytes, std::size_t piece) {
  std::vector<grpc::Slice> slices;
  for (; !bytes.empty(); bytes.remove_prefix(std::min(piece, bytes.size()))) {
    slices.emplace_back(bytes.data(), std::min(piece, bytes.size()));
  }
  if (slices.empty()) slices.emplace_back("");
  return {slices.data(), slices.size()};
}

/// Whether the bytes are such a message.
template <class Message>
bool read_message(std::string_view bytes, Message& message) {
  const bool is_one = parse(buffer_of(bytes, bytes.size() + 1), message);
  Message in_pieces;
  expect(parse(buffer_of(bytes, 3), in_pieces) == is_one);
  if (is_one) expect(in_pieces.SerializeAsString() == message.SerializeAsString());
  return is_one;
}

/// The short way to a chunk finds what the parser finds, or nothing.
template <class Message>
void read_chunk(std::string_view bytes) {
  const auto in_pieces = only_field(buffer_of(bytes, 3), Message::kChunkFieldNumber);
  expect(in_pieces.has_value() ==
         only_field(buffer_of(bytes, bytes.size() + 1), Message::kChunkFieldNumber).has_value());
  if (!in_pieces) return;
  std::string joined;
  for (const grpc::Slice& slice : *in_pieces) joined.append(reinterpret_cast<const char*>(slice.begin()), slice.size());
  Message message;
  expect(parse(buffer_of(bytes, bytes.size() + 1), message) && message.chunk() == joined);
}

/// The next message of a stream, with its length of two bytes before it.
std::optional<std::string_view> next(std::string_view& stream) {
  if (stream.size() < 2) return std::nullopt;
  const auto length = static_cast<unsigned char>(stream[0]) * std::size_t{256} + static_cast<unsigned char>(stream[1]);
  const std::string_view message = stream.substr(2, length);
  stream.remove_prefix(2 + message.size());
  return message;
}

std::string canonical(const geosis::ReconstructOptions& options) {
  return canonical_text(request_document(options, {64, 64, 64}));
}

/// What is accepted means the same when it has gone through a message once more.
void take_request(const geosis::v1::Request& request) {
  const auto document = document_of(request);
  if (!document) return;
  expect(parse_json(document_text(*document)).has_value());
  const auto options = parse_request(*document);
  if (!options) return;
  geosis::v1::Request answered;
  set_message(answered, request_document(*options, {64, 64, 64}));
  const auto again = document_of(answered);
  expect(again.has_value());
  const auto meant = parse_request(*again);
  expect(meant.has_value());
  expect(canonical(*meant) == canonical(*options));
}

/// A client's stream, its chunks read back as the file's thread would.
template <class Message>
std::optional<Message> take_stream(std::string_view stream) {
  using Next = typename FileReceiver<Message>::Next;
  FileReceiver<Message> receiver(room(), [] {});
  std::size_t sent = 0;
  for (;;) {
    const auto bytes = next(stream);
    if (bytes) {
      Message message;
      read_message(*bytes, message);
      read_chunk<Message>(*bytes);
      sent += bytes->size();
    }
    const auto what = receiver.take(buffer_of(bytes.value_or(""), 5), bytes.has_value());
    if (what == Next::refuse) {
      expect(!receiver.refusal().message.empty());
      return std::nullopt;
    }
    if (!bytes) break;
  }
  std::vector<std::byte> file(sent + 1);
  std::size_t received = 0;
  for (;;) {
    const auto count = receiver.inbox().read(std::span(file).subspan(received));
    if (!count || *count == 0) break;
    received += *count;
    expect(received <= sent);
  }
  static_cast<void>(receiver.inbox().check());
  return receiver.options();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data + 1), size - 1);
  switch (data[0] % 4) {
    case 0:
      take_stream<geosis::v1::UploadVolumeRequest>(bytes);
      break;
    case 1:
      if (const auto first = take_stream<geosis::v1::ExtractRequest>(bytes)) take_request(first->options().request());
      break;
    case 2: {
      geosis::v1::CreateExtractionRequest request;
      if (read_message(bytes, request)) take_request(request.request());
      break;
    }
    default: {
      geosis::v1::StreamLodsRequest request;
      read_message(bytes, request);
    }
  }
  return 0;
}
