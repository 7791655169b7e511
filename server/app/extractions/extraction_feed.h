#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "engine/base/result.h"
#include "server/app/extractions/extraction.h"

namespace geosis::server {

struct NothingYet {};  ///< the bell given to on_ready() will ring
struct NoMore {};

/// What becomes known of an extraction, piece by piece, each as soon as it is there. One thread asks at a time.
class ExtractionFeed {
 public:
  /// bell   called from any thread after NothingYet, when there may be more. Replaces an earlier one.
  void on_ready(std::function<void()> bell) { bell_->set(std::move(bell)); }

 protected:
  explicit ExtractionFeed(std::shared_ptr<Extraction> extraction);
  const Extraction& extraction() const { return *extraction_; }
  /// The extraction as it is now; what changes later rings again. A snapshot costs as much as its levels have parts: it
  /// is taken again only after the bell has rung.
  const Extraction::Snapshot& look();

 private:
  class Bell {
   public:
    void set(std::function<void()> listener);
    void ring();
    /// Whether it has rung since the last time.
    bool take();

   private:
    std::mutex mutex_;
    std::function<void()> listener_;
    bool rung_ = false;
  };

  const std::shared_ptr<Extraction> extraction_;
  const std::shared_ptr<Bell> bell_ = std::make_shared<Bell>();
  const Job::Subscription subscription_;
  std::optional<Extraction::Snapshot> seen_;
};

/// One event: progress (no id), each level as it is ready (id 1, 2, ...), at last done or failed (the next id).
struct ExtractionEvent {
  enum class Kind { progress, level, done, failed };
  Kind kind;
  std::uint64_t id = 0;  ///< 0 = none
  Json data;             ///< {"stage", "progress"}; the level's entry; the resource; the problem
};

class EventFeed final : public ExtractionFeed {
 public:
  /// after   id of the last event that the reader knows; its levels are not told again.
  EventFeed(std::shared_ptr<Extraction> extraction, std::uint64_t after)
      : ExtractionFeed(std::move(extraction)), told_(after) {}

  std::variant<ExtractionEvent, NothingYet, NoMore> next();

 private:
  std::uint64_t told_;  // levels that the reader knows
  std::pair<std::string, int> shown_{"", -1};
  bool has_ended_ = false;
};

/// Whether the reader of event `after` was told the end: there is nothing more to say.
bool knows_the_end(const Extraction& extraction, std::uint64_t after);

/// One part of a level, whole.
struct LevelPart {
  int level = 0, part = 0, parts = 0;
  bool is_preview = false;
  std::vector<std::byte> bytes;
};

/// The parts of every level as soon as it is ready, coarsest first, and the manifest last.
class LevelFeed final : public ExtractionFeed {
 public:
  struct Options {
    std::optional<int> from_level = std::nullopt;  ///< coarser ones are left out
    std::function<void()> abandoned = {};          ///< called when the feed goes before its end: the reader left
  };

  LevelFeed(std::shared_ptr<Extraction> extraction, Options options)
      : ExtractionFeed(std::move(extraction)), options_(std::move(options)) {}
  ~LevelFeed();

  using Piece = std::variant<LevelPart, Json, NothingYet, NoMore>;  ///< Json: the manifest
  /// errors   the extraction's; those of reading a part.
  Result<Piece> next();

 private:
  Result<Piece> read_part(const Json& entry);

  const Options options_;
  std::size_t level_ = 0;  // in the order of readiness
  int part_ = 0;
  bool has_ended_ = false;
};

/// What a feed that carries the answer itself does when its reader goes away: one interest less.
std::function<void()> abandonment(const std::shared_ptr<Extraction>& extraction);

}  // namespace geosis::server
