#include "server/app/extractions/extraction_feed.h"

#include <utility>

#include "server/app/problem.h"

namespace geosis::server {

// ---- the bell, which remembers a ring that nobody waited for

void ExtractionFeed::Bell::set(std::function<void()> listener) {
  const std::lock_guard lock(mutex_);
  listener_ = std::move(listener);
  if (rung_ && listener_) listener_();
}

void ExtractionFeed::Bell::ring() {
  const std::lock_guard lock(mutex_);
  rung_ = true;
  if (listener_) listener_();
}

bool ExtractionFeed::Bell::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(rung_, false);
}

ExtractionFeed::ExtractionFeed(std::shared_ptr<Extraction> extraction)
    : extraction_(std::move(extraction)), subscription_(extraction_->subscribe([bell = bell_] { bell->ring(); })) {}

const Extraction::Snapshot& ExtractionFeed::look() {
  const bool has_rung = bell_->take();  // before looking: what comes later rings again
  if (has_rung || !seen_) seen_ = extraction_->snapshot();
  return *seen_;
}

// ---- events

std::variant<ExtractionEvent, NothingYet, NoMore> EventFeed::next() {
  using Kind = ExtractionEvent::Kind;
  if (has_ended_) return NoMore{};
  const Extraction::Snapshot& now = look();
  if (told_ < now.levels.size()) {
    const std::uint64_t id = ++told_;
    return ExtractionEvent{Kind::level, id, shown_level(extraction(), now.levels[id - 1])};
  }
  if (is_final(now.state)) {
    has_ended_ = true;
    const std::uint64_t id = now.levels.size() + 1;
    if (now.state == JobState::done) return ExtractionEvent{Kind::done, id, resource_document(extraction())};
    return ExtractionEvent{Kind::failed, id,
                           problem_document(now.error.value_or(Error{ErrorCode::cancelled, "cancelled"}))};
  }
  const std::pair progress{now.stage, static_cast<int>(now.progress * 100)};
  if (progress == shown_) return NothingYet{};
  shown_ = progress;
  return ExtractionEvent{Kind::progress, 0, {{"stage", now.stage}, {"progress", now.progress}}};
}

bool knows_the_end(const Extraction& extraction, std::uint64_t after) {
  if (after == 0 || !extraction.has_ended()) return false;
  return after > extraction.snapshot().levels.size();
}

// ---- levels

LevelFeed::~LevelFeed() {
  if (!has_ended_ && options_.abandoned) options_.abandoned();
}

Result<LevelFeed::Piece> LevelFeed::next() {
  if (has_ended_) return Piece(NoMore{});
  const Extraction::Snapshot& now = look();
  const auto is_left_out = [&](const Json& entry) {
    return options_.from_level && entry.at("level").get<int>() > *options_.from_level;
  };
  while (level_ < now.levels.size() && is_left_out(now.levels[level_])) ++level_;
  if (level_ < now.levels.size()) return read_part(now.levels[level_]);
  if (now.manifest) {
    has_ended_ = true;
    return Piece(*now.manifest);
  }
  if (!is_final(now.state)) return Piece(NothingYet{});
  return now.error.value_or(Error{ErrorCode::cancelled, "the extraction was cancelled"});
}

Result<LevelFeed::Piece> LevelFeed::read_part(const Json& entry) {
  LevelPart piece;
  piece.level = entry.at("level").get<int>();
  piece.part = part_;
  piece.parts = static_cast<int>(entry.at("parts").size());
  piece.is_preview = entry.at("preview").get<bool>();
  auto bytes = extraction().read_part(piece.level, part_);
  if (!bytes) return std::move(bytes).error();
  piece.bytes = *std::move(bytes);
  if (++part_ == piece.parts) {
    part_ = 0;
    ++level_;
  }
  return Piece(std::move(piece));
}

std::function<void()> abandonment(const std::shared_ptr<Extraction>& extraction) {
  return [watched = std::weak_ptr(extraction)] {
    if (const auto held = watched.lock()) held->abandon();
  };
}

}  // namespace geosis::server
