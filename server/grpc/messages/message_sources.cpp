#include "server/grpc/messages/message_sources.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <grpcpp/support/slice.h>

#include "server/grpc/messages/message_codec.h"
#include "server/grpc/messages/wire.h"

namespace geosis::server::rpc {
namespace {

constexpr std::size_t kChunk = 256 * 1024;

class EventSource final : public MessageSource<v1::ExtractionEvent> {
 public:
  EventSource(std::shared_ptr<Extraction> extraction, std::uint64_t after) : feed_(std::move(extraction), after) {}
  void on_ready(std::function<void()> bell) override { feed_.on_ready(std::move(bell)); }

  Result<State> next(v1::ExtractionEvent& message) override {
    using Kind = ExtractionEvent::Kind;
    const auto next = feed_.next();
    if (std::holds_alternative<NothingYet>(next)) return State::nothing_yet;
    if (std::holds_alternative<NoMore>(next)) return State::end;
    const auto& event = std::get<ExtractionEvent>(next);
    message.Clear();
    message.set_id(event.id);
    switch (event.kind) {
      case Kind::progress:
        set_message(*message.mutable_progress(), event.data);
        break;
      case Kind::level:
        set_message(*message.mutable_level(), event.data);
        break;
      case Kind::done:
        set_message(*message.mutable_done(), event.data);
        break;
      case Kind::failed:
        set_message(*message.mutable_failed(), event.data);
        break;
    }
    return State::message;
  }

 private:
  EventFeed feed_;
};

template <class Message>
class EmptySource final : public MessageSource<Message> {
 public:
  using State = typename MessageSource<Message>::State;
  Result<State> next(Message&) override { return State::end; }
  void on_ready(std::function<void()>) override {}
};

using Bytes = std::vector<std::byte>;
using SharedBytes = std::shared_ptr<const Bytes>;

/// A piece of bytes that live as long as gRPC has it.
grpc::Slice slice_of(const SharedBytes& bytes, std::size_t first, std::size_t count) {
  const auto release = [](void* held) { delete static_cast<SharedBytes*>(held); };
  return {const_cast<std::byte*>(bytes->data() + first), count, release, new SharedBytes(bytes)};  // gRPC only reads
}

/// The start of a field that holds so many bytes.
void add_field(std::string& text, int number, std::size_t bytes) {
  google::protobuf::io::StringOutputStream stream(&text);
  google::protobuf::io::CodedOutputStream out(&stream);
  out.WriteTag(static_cast<std::uint32_t>(number << 3 | 2));
  out.WriteVarint64(bytes);
}

/// LodChunk{part = chunk} whose data, the last field on the wire, are these. chunk   without data.
grpc::ByteBuffer wire_chunk(const v1::PartChunk& chunk, grpc::Slice data) {
  std::string fields = chunk.SerializeAsString();
  add_field(fields, v1::PartChunk::kDataFieldNumber, data.size());
  std::string head;
  add_field(head, v1::LodChunk::kPartFieldNumber, fields.size() + data.size());
  const grpc::Slice slices[] = {grpc::Slice(head + fields), std::move(data)};
  return {slices, 2};
}

class LodSource final : public MessageSource<grpc::ByteBuffer> {
 public:
  LodSource(std::shared_ptr<Extraction> extraction, LevelFeed::Options options)
      : feed_(std::move(extraction), std::move(options)) {}
  void on_ready(std::function<void()> bell) override { feed_.on_ready(std::move(bell)); }

  Result<State> next(grpc::ByteBuffer& message) override {
    if (!bytes_) {
      auto next = feed_.next();
      if (!next) return std::move(next).error();
      if (std::holds_alternative<NothingYet>(*next)) return State::nothing_yet;
      if (std::holds_alternative<NoMore>(*next)) return State::end;
      if (const auto* manifest = std::get_if<Json>(&*next)) {
        message = wire_manifest(*manifest);
        return State::message;
      }
      begin(std::get<LevelPart>(*std::move(next)));
    }
    message = next_chunk();
    return State::message;
  }

 private:
  static grpc::ByteBuffer wire_manifest(const Json& manifest) {
    v1::LodChunk chunk;
    set_message(*chunk.mutable_manifest(), manifest);
    return serialized(chunk);
  }

  void begin(LevelPart part) {
    chunk_.set_level(part.level);
    chunk_.set_part(part.part);
    chunk_.set_parts(part.parts);
    chunk_.set_preview(part.is_preview);
    chunk_.set_bytes(part.bytes.size());
    bytes_ = std::make_shared<const Bytes>(std::move(part.bytes));
    sent_ = 0;
  }

  grpc::ByteBuffer next_chunk() {
    const std::size_t first = sent_, count = std::min(kChunk, bytes_->size() - first);
    sent_ += count;
    chunk_.set_is_last(sent_ == bytes_->size());
    auto message = wire_chunk(chunk_, slice_of(bytes_, first, count));
    if (chunk_.is_last()) bytes_.reset();
    return message;
  }

  LevelFeed feed_;
  v1::PartChunk chunk_;  // of the part that is being sent, without data
  SharedBytes bytes_;    // null: the next part is not there yet
  std::size_t sent_ = 0;
};

}  // namespace

std::unique_ptr<MessageSource<v1::ExtractionEvent>> event_source(std::shared_ptr<Extraction> extraction,
                                                                 std::uint64_t after) {
  if (knows_the_end(*extraction, after)) return std::make_unique<EmptySource<v1::ExtractionEvent>>();
  return std::make_unique<EventSource>(std::move(extraction), after);
}

std::unique_ptr<MessageSource<grpc::ByteBuffer>> lod_source(std::shared_ptr<Extraction> extraction,
                                                            LevelFeed::Options options) {
  return std::make_unique<LodSource>(std::move(extraction), std::move(options));
}

}  // namespace geosis::server::rpc
