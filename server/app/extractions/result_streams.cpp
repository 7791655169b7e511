#include "server/app/extractions/result_streams.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <utility>
#include <variant>

#include "server/app/extractions/extraction_feed.h"
#include "server/store/piece_sums.h"

namespace geosis::server {
namespace {

using Pulled = ByteStream::Pulled;

/// A stream that makes its bytes piece by piece: the next piece is made when the one before has been taken.
class PieceStream : public ByteStream {
 public:
  Result<Pulled> pull(std::span<std::byte> into) final {
    while (taken_ == piece_.size()) {
      piece_.clear();
      taken_ = 0;
      auto state = next_piece(piece_);
      if (!state) return std::move(state).error();
      if (*state != Pulled::State::data) return Pulled{*state, 0};
    }
    const std::size_t count = std::min(into.size(), piece_.size() - taken_);
    std::memcpy(into.data(), piece_.data() + taken_, count);
    taken_ += count;
    return Pulled{Pulled::State::data, count};
  }
  void on_ready(std::function<void()>) override {}

 protected:
  /// Appends to `piece` (data), or says that nothing is there yet, or ever.
  virtual Result<Pulled::State> next_piece(std::string& piece) = 0;

 private:
  std::string piece_;
  std::size_t taken_ = 0;
};

class BytesStream final : public PieceStream {
 public:
  explicit BytesStream(std::vector<std::byte> bytes) : bytes_(std::move(bytes)) {}

 private:
  Result<Pulled::State> next_piece(std::string& piece) override {
    if (std::exchange(is_taken_, true) || bytes_.empty()) return Pulled::State::end;
    piece.assign(reinterpret_cast<const char*>(bytes_.data()), bytes_.size());
    return Pulled::State::data;
  }

  const std::vector<std::byte> bytes_;
  bool is_taken_ = false;
};

class FileStream final : public PieceStream {
 public:
  FileStream(std::ifstream file, std::vector<std::uint64_t> sums, std::function<void()> damaged)
      : file_(std::move(file)), sums_(std::move(sums)), damaged_(std::move(damaged)) {}

 private:
  Result<Pulled::State> next_piece(std::string& piece) override {
    if (next_ == sums_.size()) return Pulled::State::end;
    piece.resize(kSummedPiece);
    file_.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    piece.resize(static_cast<std::size_t>(file_.gcount()));
    if (file_.bad()) return Error{ErrorCode::unavailable, "reading a stored file failed"};
    if (sum_of_piece(std::as_bytes(std::span(piece))) == sums_[next_++]) return Pulled::State::data;
    piece.clear();
    damaged_();
    return Error{ErrorCode::internal, "a stored file is damaged"};
  }

  std::ifstream file_;
  const std::vector<std::uint64_t> sums_;
  const std::function<void()> damaged_;
  std::size_t next_ = 0;
};

const char* name_of(ExtractionEvent::Kind kind) {
  switch (kind) {
    case ExtractionEvent::Kind::progress:
      return "progress";
    case ExtractionEvent::Kind::level:
      return "level";
    case ExtractionEvent::Kind::done:
      return "done";
    case ExtractionEvent::Kind::failed:
      return "failed";
  }
  return "";
}

class EventStream final : public PieceStream {
 public:
  EventStream(std::shared_ptr<Extraction> extraction, std::uint64_t after) : feed_(std::move(extraction), after) {}
  void on_ready(std::function<void()> bell) override { feed_.on_ready(std::move(bell)); }
  std::string_view idle_text() const override { return ":\n\n"; }

 private:
  Result<Pulled::State> next_piece(std::string& piece) override {
    const auto next = feed_.next();
    if (std::holds_alternative<NothingYet>(next)) return Pulled::State::wait;
    if (std::holds_alternative<NoMore>(next)) return Pulled::State::end;
    const auto& event = std::get<ExtractionEvent>(next);
    if (event.id > 0) piece += "id: " + std::to_string(event.id) + "\n";
    piece += std::string("event: ") + name_of(event.kind) +
             "\ndata: " + event.data.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n\n";
    return Pulled::State::data;
  }

  EventFeed feed_;
};

class LevelStream final : public PieceStream {
 public:
  LevelStream(std::shared_ptr<Extraction> extraction, std::string boundary, std::function<void()> abandoned)
      : feed_(std::move(extraction), {.abandoned = std::move(abandoned)}), boundary_(std::move(boundary)) {}
  void on_ready(std::function<void()> bell) override { feed_.on_ready(std::move(bell)); }

 private:
  Result<Pulled::State> next_piece(std::string& piece) override {
    const auto next = feed_.next();
    if (!next) return next.error();
    if (std::holds_alternative<NothingYet>(*next)) return Pulled::State::wait;
    if (std::holds_alternative<NoMore>(*next)) return Pulled::State::end;
    if (const auto* manifest = std::get_if<Json>(&*next))
      add_manifest(piece, *manifest);
    else
      add_part(piece, std::get<LevelPart>(*next));
    return Pulled::State::data;
  }

  void add_part(std::string& piece, const LevelPart& part) const {
    begin(piece, "model/vnd.google.draco", part.bytes.size());
    piece += "X-Geosis-Level: " + std::to_string(part.level) + "\r\nX-Geosis-Part: " + std::to_string(part.part) +
             "\r\nX-Geosis-Parts: " + std::to_string(part.parts) +
             "\r\nX-Geosis-Preview: " + (part.is_preview ? "true" : "false") + "\r\n\r\n";
    piece.append(reinterpret_cast<const char*>(part.bytes.data()), part.bytes.size());
    piece += "\r\n";
  }

  void add_manifest(std::string& piece, const Json& manifest) const {
    const std::string text = document_text(manifest);
    begin(piece, "application/json", text.size());
    piece += "\r\n" + text + "\r\n--" + boundary_ + "--\r\n";
  }

  void begin(std::string& piece, const char* type, std::size_t bytes) const {
    piece += "--" + boundary_ + "\r\nContent-Type: " + type + "\r\nContent-Length: " + std::to_string(bytes) + "\r\n";
  }

  LevelFeed feed_;
  const std::string boundary_;
};

}  // namespace

std::unique_ptr<ByteStream> bytes_stream(std::vector<std::byte> bytes) {
  return std::make_unique<BytesStream>(std::move(bytes));
}

Result<std::unique_ptr<ByteStream>> file_stream(const std::string& path, std::vector<std::uint64_t> sums,
                                                std::function<void()> damaged) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return Error{ErrorCode::not_found, "a stored file is gone"};
  return std::unique_ptr<ByteStream>(
      std::make_unique<FileStream>(std::move(file), std::move(sums), std::move(damaged)));
}

std::unique_ptr<ByteStream> event_stream(std::shared_ptr<Extraction> extraction, std::uint64_t after) {
  return std::make_unique<EventStream>(std::move(extraction), after);
}

std::unique_ptr<ByteStream> level_stream(std::shared_ptr<Extraction> extraction, std::string boundary,
                                         std::function<void()> abandoned) {
  return std::make_unique<LevelStream>(std::move(extraction), std::move(boundary), std::move(abandoned));
}

std::string transform_text(const Json& transform) {
  std::string text;
  for (const Json& number : transform) text += (text.empty() ? "" : ", ") + number.dump();
  return text;
}

}  // namespace geosis::server
