#include "server/grpc/message_sources.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <variant>

#include "server/grpc/message_codec.h"

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

class LodSource final : public MessageSource<v1::LodChunk> {
 public:
  LodSource(std::shared_ptr<Extraction> extraction, LevelFeed::Options options)
      : feed_(std::move(extraction), std::move(options)) {}
  void on_ready(std::function<void()> bell) override { feed_.on_ready(std::move(bell)); }

  Result<State> next(v1::LodChunk& message) override {
    if (sent_ == part_.bytes.size()) {
      auto next = feed_.next();
      if (!next) return std::move(next).error();
      if (std::holds_alternative<NothingYet>(*next)) return State::nothing_yet;
      if (std::holds_alternative<NoMore>(*next)) return State::end;
      if (const auto* manifest = std::get_if<Json>(&*next)) {
        message.Clear();
        set_message(*message.mutable_manifest(), *manifest);
        return State::message;
      }
      part_ = std::get<LevelPart>(*std::move(next));
      sent_ = 0;
    }
    write_chunk(*message.mutable_part());
    return State::message;
  }

 private:
  void write_chunk(v1::PartChunk& chunk) {
    const std::size_t count = std::min(kChunk, part_.bytes.size() - sent_);
    chunk.set_level(part_.level);
    chunk.set_part(part_.part);
    chunk.set_parts(part_.parts);
    chunk.set_preview(part_.is_preview);
    chunk.set_bytes(part_.bytes.size());
    chunk.set_data(part_.bytes.data() + sent_, count);
    sent_ += count;
    chunk.set_is_last(sent_ == part_.bytes.size());
    if (chunk.is_last()) part_ = {};
    if (chunk.is_last()) sent_ = 0;
  }

  LevelFeed feed_;
  LevelPart part_;  // what is being sent
  std::size_t sent_ = 0;
};

}  // namespace

std::unique_ptr<MessageSource<v1::ExtractionEvent>> event_source(std::shared_ptr<Extraction> extraction,
                                                                 std::uint64_t after) {
  if (knows_the_end(*extraction, after)) return std::make_unique<EmptySource<v1::ExtractionEvent>>();
  return std::make_unique<EventSource>(std::move(extraction), after);
}

std::unique_ptr<MessageSource<v1::LodChunk>> lod_source(std::shared_ptr<Extraction> extraction,
                                                        LevelFeed::Options options) {
  return std::make_unique<LodSource>(std::move(extraction), std::move(options));
}

}  // namespace geosis::server::rpc
