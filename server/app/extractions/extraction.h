#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/result.h"
#include "server/documents/json_text.h"
#include "server/jobs/job.h"

namespace geosis::server {

/// Seconds of each stage so far; first_level = until the coarsest level could leave.
struct ExtractionTimings {
  double load = 0, grid = 0, fill = 0, extract = 0, simplify = 0, encode = 0, certify = 0, first_level = 0, total = 0;
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
    std::string asked_by = {};  ///< id of the call that made it start here, for the log; empty: none did
  };
  struct Snapshot {
    JobState state = JobState::queued;
    std::string stage;
    double progress = 0;
    std::optional<Error> error;
    std::vector<Json> levels;      ///< entries ready so far, coarsest first
    std::optional<Json> manifest;  ///< once it is done
    Json empty_because;            ///< empty_reason_document()'s
    std::optional<ExtractionTimings> timings;
  };

  /// is_stored   true: the store has it, and interest in it is the store's to count. False: it lives and dies here.
  Extraction(Identity identity, PartReader parts, bool is_stored = true)
      : identity_(std::move(identity)), parts_(std::move(parts)), is_stored_(is_stored) {}

  const Identity& identity() const { return identity_; }
  Result<std::vector<std::byte>> read_part(int level, int part) const { return parts_(level, part); }

  Snapshot snapshot() const;
  /// Rings after every change until the subscription ends; at once never. No bell for what is final already.
  Job::Subscription subscribe(std::function<void()> bell);
  /// Waits until it has ended or the time is over.
  void wait_for(std::chrono::milliseconds time) const { face_->wait_for(time); }
  /// Done, failed or cancelled. Quicker than a snapshot.
  bool has_ended() const { return is_final(face_->status().state); }
  bool is_done() const;
  /// A reader of the answer itself went away: takes one interest away, or ends what is not stored. At once; nobody
  /// waits for it to be durable.
  void abandon();

  // For whoever computes or follows it.
  /// What computes it in this process from now on.
  void set_work(std::shared_ptr<Job> work);
  /// Ends the work in this process and nothing else: somebody else goes on.
  void stop_work();
  bool wait_for_work(std::chrono::milliseconds time) const;
  void report(const char* stage, double fraction);
  bool is_cancelled() const { return face_->cancelled(); }
  /// One that is known already is not added again.
  void add_level(Json entry);
  /// Done. Levels take the manifest's full entries.
  ///
  /// empty_because   null when there are levels, or when nobody knows.
  void complete(const Json& manifest, std::optional<ExtractionTimings> timings, Json empty_because);
  /// Ended without a result.
  void fail(Error error) { face_->finish(std::move(error)); }
  /// Nobody wants it any more: it ends as cancelled, the work in this process with it.
  void cancel();
  /// Interests that were abandoned since the last call.
  int take_abandoned() { return abandoned_.exchange(0); }

 private:
  const Identity identity_;
  const PartReader parts_;
  const bool is_stored_;
  /// The extraction as others see it, whoever computes it: state, progress, bells. Never in a queue itself.
  const std::shared_ptr<Job> face_ = std::make_shared<Job>();
  std::atomic<int> abandoned_{0};
  mutable std::mutex mutex_;
  std::shared_ptr<Job> work_;
  std::vector<Json> levels_;  ///< until the manifest has them
  std::string manifest_;      ///< its text, a twentieth of its size as a value; empty until it is done
  std::optional<ExtractionTimings> timings_;
  Json empty_because_;
};

/// Tells an extraction's face of the progress of the work that computes it, and the work of its cancellation.
class ExtractionProgress final : public Progress {
 public:
  ExtractionProgress(Extraction& extraction, Progress& work) : extraction_(extraction), work_(work) {}
  void report(const char* stage, double fraction) override {
    work_.report(stage, fraction);
    extraction_.report(stage, fraction);
  }
  bool cancelled() const override { return work_.cancelled() || extraction_.is_cancelled(); }

 private:
  Extraction& extraction_;
  Progress& work_;
};

/// A level's entry beside no manifest: its urls, which are relative to the manifest, are paths of the server.
Json shown_level(const Extraction& extraction, Json entry);

/// The resource of the outside contract.
Json resource_document(const Extraction& extraction);

}  // namespace geosis::server
