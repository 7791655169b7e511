#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "server/documents/json_text.h"
#include "server/jobs/job.h"

namespace geosis::server {

/// Seconds of each stage so far; first_level = until the coarsest level could leave.
struct ExtractionTimings {
  double load = 0, fill = 0, extract = 0, simplify = 0, encode = 0, certify = 0, first_level = 0, total = 0;
};

/// Reads the bytes of one encoded part.
using PartReader = std::function<Result<std::vector<std::byte>>(int level, int part)>;

/// One extraction as everybody who watches it sees it: what was asked, the levels that are ready (coarsest first), and
/// in the end the manifest. Any thread may call any member.
class Extraction {
 public:
  struct Identity {
    std::string id, volume, created_at;
    Json request;
  };
  struct Snapshot {
    JobState state = JobState::queued;
    std::string stage;
    double progress = 0;
    std::optional<Error> error;
    std::vector<Json> levels;      ///< entries ready so far, coarsest first
    std::optional<Json> manifest;  ///< once it is done
    std::optional<ExtractionTimings> timings;
  };

  Extraction(Identity identity, PartReader parts) : identity_(std::move(identity)), parts_(std::move(parts)) {}

  const Identity& identity() const { return identity_; }
  Result<std::vector<std::byte>> read_part(int level, int part) const { return parts_(level, part); }

  Snapshot snapshot() const;
  /// Rings after every change until the subscription ends; at once never. No bell for what is final already.
  Job::Subscription subscribe(std::function<void()> bell);
  void wait_for(std::chrono::milliseconds time) const;
  /// Done, failed or cancelled. Quicker than a snapshot.
  bool has_ended() const;

  // For whoever computes it.
  void set_job(std::shared_ptr<Job> job);
  void add_level(Json entry);
  /// Done. Levels take the manifest's full entries.
  void complete(Json manifest, std::optional<ExtractionTimings> timings);
  /// Stopped before anybody computed it, by a cancellation that the store remembers.
  void set_cancelled();

  // Interest: every POST adds one; when the last is withdrawn the work stops.
  /// False when it is ending without a result: whoever asks now must start it anew.
  bool add_interest();
  /// True when none is left and the work has not ended: it is ending from now on, and the caller calls cancel().
  bool withdraw_interest();
  void cancel();
  /// Nobody wants it any more, and it has no result: it ends, or has ended, as cancelled.
  bool is_ending() const;

 private:
  const Identity identity_;
  const PartReader parts_;
  mutable std::mutex mutex_;
  std::shared_ptr<Job> job_;
  std::vector<Json> levels_;
  std::optional<Json> manifest_;
  std::optional<ExtractionTimings> timings_;
  bool cancelled_ = false;  ///< before anybody computed it
  bool ending_ = false;
  int interest_ = 0;
};

/// The resource of the outside contract.
Json resource_document(const Extraction& extraction);

}  // namespace geosis::server
