#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "engine/base/result.h"
#include "server/app/extractions/extraction.h"
#include "server/app/extractions/run_record.h"
#include "server/store/blob_store.h"

namespace geosis::server {

struct WatchTiming {
  std::chrono::milliseconds tick{50};                          ///< between two looks at the store
  std::chrono::milliseconds lease = std::chrono::seconds(10);  ///< renewed four times in it
};

/// Keeps this process's unfinished extractions in step with the store, on a thread of its own: renews the leases of
/// those that are computed here and stops those that nobody wants any more; follows those that others compute, and
/// claims them when their owner is gone. Any thread may call any member.
///
/// A lease is over when its owner's process has ended, as far as the store can tell, or when its beat stands still for
/// the time of the lease, by the clock of whoever watches it: no two clocks are compared.
class ExtractionWatch {
 public:
  /// Computes an extraction under a lease that was claimed for it. False: not now (the queue is full).
  using Start = std::function<bool(const std::shared_ptr<Extraction>&, const std::string& owner)>;

  ExtractionWatch(BlobStore& store, RunRecords& records, std::string tenant, WatchTiming timing, Start start);
  ExtractionWatch(const ExtractionWatch&) = delete;
  ExtractionWatch& operator=(const ExtractionWatch&) = delete;
  ~ExtractionWatch();

  /// A name for a new run: "<process>.<number>".
  std::string new_owner() const;
  /// Makes a record the owner's, if nobody has its lease for certain. For use in RunRecords::update.
  bool claim(RunRecord& record, const std::string& owner) const;
  /// The run of that name did not begin, or has ended: whatever the store still says, its lease is over.
  void disown(const std::string& owner) const;

  /// Follows an extraction that others compute, until it ends here or nobody holds it.
  void follow(const std::shared_ptr<Extraction>& extraction) { add(extraction, ""); }
  /// Renews the lease of one that is computed here, until released.
  void renew(const std::shared_ptr<Extraction>& extraction, const std::string& owner) { add(extraction, owner); }
  /// False when the lease has been lost: another one computes it, or nobody wants it any more.
  bool holds(const Extraction& extraction, const std::string& owner);
  /// Gives the lease back and ends the extraction as its run ended: failed, or cancelled. After done, what only those
  /// need who wait is removed. When the lease was lost, the extraction is followed instead.
  void release(const std::shared_ptr<Extraction>& extraction, const std::string& owner, const Result<void>& outcome);
  /// What the store says of a result without levels; null for others, and where it does not say.
  Json empty_because(const Extraction& extraction, const Json& manifest) const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Watched {
    Watched(const std::shared_ptr<Extraction>& which, std::string whose)
        : extraction(which), owner(std::move(whose)), renewed(Clock::now()) {}

    std::mutex mutex;  ///< of all but the extraction; held while it is looked at
    const std::weak_ptr<Extraction> extraction;
    std::string owner;  ///< "" = computed by others
    Clock::time_point renewed;
    std::size_t published = 0;  ///< levels that levels.json tells of
    std::string seen_owner;     ///< of a lease that others have
    std::uint64_t seen_beat = 0;
    Clock::time_point seen_at{};  ///< when that beat was first seen
  };

  void add(const std::shared_ptr<Extraction>& extraction, const std::string& owner);
  std::shared_ptr<Watched> watched(const Extraction& extraction);
  void run(const std::stop_token& stop);
  // Each returns false when there is nothing more to watch.
  bool look_at(Watched& watched);
  bool follow_one(const std::shared_ptr<Extraction>& extraction, Watched& watched);
  bool renew_one(const std::shared_ptr<Extraction>& extraction, Watched& watched);
  void withdraw_abandoned(Extraction& extraction);
  void renew_lease(Extraction& extraction, Watched& watched);
  void take_over(const std::shared_ptr<Extraction>& extraction, Watched& watched);
  bool is_over(const RunRecord& record, Watched& watched) const;
  void own(RunRecord& record, const std::string& owner) const;
  bool has_certainly_ended(const std::string& owner) const;
  void read_levels(Extraction& extraction);
  Result<Json> read(const Extraction& extraction, const char* name) const;
  bool exists(const Extraction& extraction, const char* name) const;
  BlobKey key(const Extraction& extraction, const char* name) const;

  BlobStore& store_;
  RunRecords& records_;
  const std::string tenant_;
  const WatchTiming timing_;
  const Start start_;
  std::mutex mutex_;  ///< of what follows; never held while one is looked at
  std::condition_variable_any changed_;
  bool has_news_ = false;
  std::map<const Extraction*, std::shared_ptr<Watched>> watched_;
  std::jthread thread_;  ///< last: it uses all above
};

}  // namespace geosis::server
