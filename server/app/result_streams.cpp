#include "server/app/result_streams.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <mutex>
#include <utility>

#include "server/app/problem.h"
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

/// Carries the extraction's bell to whoever waits for the stream, and remembers a ring that nobody waited for.
class Bell {
 public:
  void set(std::function<void()> listener) {
    const std::lock_guard lock(mutex_);
    listener_ = std::move(listener);
    if (rung_ && listener_) listener_();
  }
  void ring() {
    const std::lock_guard lock(mutex_);
    rung_ = true;
    if (listener_) listener_();
  }
  void clear() {
    const std::lock_guard lock(mutex_);
    rung_ = false;
  }

 private:
  std::mutex mutex_;
  std::function<void()> listener_;
  bool rung_ = false;
};

/// A stream of what becomes known of an extraction.
class ExtractionStream : public PieceStream {
 public:
  explicit ExtractionStream(std::shared_ptr<Extraction> extraction)
      : extraction_(std::move(extraction)), subscription_(extraction_->subscribe([bell = bell_] { bell->ring(); })) {}
  void on_ready(std::function<void()> listener) final { bell_->set(std::move(listener)); }

 protected:
  const std::shared_ptr<Extraction> extraction_;

  Result<Pulled::State> next_piece(std::string& piece) final {
    bell_->clear();  // before looking: what comes later rings again
    return next_news(piece, extraction_->snapshot());
  }
  virtual Result<Pulled::State> next_news(std::string& piece, const Extraction::Snapshot& now) = 0;

 private:
  const std::shared_ptr<Bell> bell_ = std::make_shared<Bell>();
  const Job::Subscription subscription_;
};

void add_event(std::string& piece, const char* name, const Json& data, std::uint64_t id = 0) {
  if (id > 0) piece += "id: " + std::to_string(id) + "\n";
  piece +=
      std::string("event: ") + name + "\ndata: " + data.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n\n";
}

class EventStream final : public ExtractionStream {
 public:
  EventStream(std::shared_ptr<Extraction> extraction, std::uint64_t after)
      : ExtractionStream(std::move(extraction)), told_(after) {}
  std::string_view idle_text() const override { return ":\n\n"; }

 private:
  Result<Pulled::State> next_news(std::string& piece, const Extraction::Snapshot& now) override {
    if (ended_) return Pulled::State::end;
    for (; told_ < now.levels.size(); ++told_) add_event(piece, "level", now.levels[told_], told_ + 1);
    if (is_final(now.state)) {
      ended_ = true;
      const std::uint64_t id = now.levels.size() + 1;
      if (now.state == JobState::done)
        add_event(piece, "done", resource_document(*extraction_), id);
      else
        add_event(piece, "failed", problem_document(now.error.value_or(Error{ErrorCode::cancelled, "cancelled"})), id);
      return Pulled::State::data;
    }
    const std::pair progress{now.stage, static_cast<int>(now.progress * 100)};
    if (progress != shown_) {
      shown_ = progress;
      add_event(piece, "progress", {{"stage", now.stage}, {"progress", now.progress}});
    }
    return piece.empty() ? Pulled::State::wait : Pulled::State::data;
  }

  std::uint64_t told_;  // levels that the reader knows
  std::pair<std::string, int> shown_{"", -1};
  bool ended_ = false;
};

class LevelStream final : public ExtractionStream {
 public:
  LevelStream(std::shared_ptr<Extraction> extraction, std::string boundary, std::function<void()> abandoned)
      : ExtractionStream(std::move(extraction)), boundary_(std::move(boundary)), abandoned_(std::move(abandoned)) {}
  ~LevelStream() override {
    if (!ended_ && abandoned_) abandoned_();
  }

 private:
  Result<Pulled::State> next_news(std::string& piece, const Extraction::Snapshot& now) override {
    if (ended_) return Pulled::State::end;
    if (level_ < now.levels.size()) return add_part(piece, now.levels[level_]);
    if (now.manifest) {
      add_manifest(piece, *now.manifest);
      ended_ = true;
      return Pulled::State::data;
    }
    if (!is_final(now.state)) return Pulled::State::wait;
    return now.error.value_or(Error{ErrorCode::cancelled, "the extraction was cancelled"});
  }

  Result<Pulled::State> add_part(std::string& piece, const Json& entry) {
    const int level = entry.at("level").get<int>();
    const auto bytes = extraction_->read_part(level, part_);
    if (!bytes) return bytes.error();
    begin(piece, "model/vnd.google.draco", bytes->size());
    piece += "X-Geosis-Level: " + std::to_string(level) + "\r\nX-Geosis-Part: " + std::to_string(part_) +
             "\r\nX-Geosis-Parts: " + std::to_string(entry.at("parts").size()) +
             "\r\nX-Geosis-Preview: " + (entry.at("preview").get<bool>() ? "true" : "false") + "\r\n\r\n";
    piece.append(reinterpret_cast<const char*>(bytes->data()), bytes->size());
    piece += "\r\n";
    if (++part_ == static_cast<int>(entry.at("parts").size())) {
      part_ = 0;
      ++level_;
    }
    return Pulled::State::data;
  }

  void add_manifest(std::string& piece, const Json& manifest) const {
    const std::string text = document_text(manifest);
    begin(piece, "application/json", text.size());
    piece += "\r\n" + text + "\r\n--" + boundary_ + "--\r\n";
  }

  void begin(std::string& piece, const char* type, std::size_t bytes) const {
    piece += "--" + boundary_ + "\r\nContent-Type: " + type + "\r\nContent-Length: " + std::to_string(bytes) + "\r\n";
  }

  const std::string boundary_;
  const std::function<void()> abandoned_;
  std::size_t level_ = 0;  // in the order of readiness
  int part_ = 0;
  bool ended_ = false;
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

bool knows_the_end(const Extraction& extraction, std::uint64_t after) {
  if (after == 0 || !extraction.has_ended()) return false;
  return after > extraction.snapshot().levels.size();
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
