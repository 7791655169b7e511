#include "server/app/extractions/extraction_watch.h"

#include <atomic>
#include <mutex>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "server/app/extractions/extraction_blobs.h"
#include "server/app/volumes/volume_blobs.h"

namespace geosis::server {
namespace {

constexpr int kRenewals = 4;  // in the time of a lease

/// Names of this process's runs that go on. What the store says of them is only as good as the disk, which may be full.
class LiveRuns {
 public:
  void add(const std::string& owner) {
    const std::lock_guard lock(mutex_);
    owners_.insert(owner);
  }
  void remove(const std::string& owner) {
    const std::lock_guard lock(mutex_);
    owners_.erase(owner);
  }
  bool contains(const std::string& owner) {
    const std::lock_guard lock(mutex_);
    return owners_.contains(owner);
  }

 private:
  std::mutex mutex_;
  std::set<std::string> owners_;
};

LiveRuns& live_runs() {
  static LiveRuns runs;
  return runs;
}

Error cancelled() {
  return {ErrorCode::cancelled, "cancelled"};
}

}  // namespace

ExtractionWatch::ExtractionWatch(BlobStore& store, RunRecords& records, std::string tenant, WatchTiming timing,
                                 Start start)
    : store_(store), records_(records), tenant_(std::move(tenant)), timing_(timing), start_(std::move(start)) {}

ExtractionWatch::~ExtractionWatch() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  changed_.notify_all();
  thread_.join();
}

BlobKey ExtractionWatch::key(const Extraction& extraction, const char* name) const {
  return tenant_ + "/extractions/" + extraction.identity().id + "/" + name;
}

Result<Json> ExtractionWatch::read(const Extraction& extraction, const char* name) const {
  const auto bytes = store_.get(key(extraction, name));
  if (!bytes) return bytes.error();
  return parse_json({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
}

Json ExtractionWatch::empty_because(const Extraction& extraction, const Json& manifest) const {
  if (!manifest.value("empty", false)) return nullptr;
  auto reason = read(extraction, kEmptyBecause);
  return reason ? *std::move(reason) : Json(nullptr);
}

bool ExtractionWatch::exists(const Extraction& extraction, const char* name) const {
  const auto found = store_.exists(key(extraction, name));
  return !found || *found;  // a store that fails says nothing
}

// ---- leases

std::string ExtractionWatch::new_owner() const {
  static std::atomic<std::uint64_t> serial{0};
  return store_.process_name() + "." + std::to_string(serial++);
}

void ExtractionWatch::own(RunRecord& record, const std::string& owner) const {
  live_runs().add(owner);
  record.owner = owner;
  record.lease_ms = timing_.lease.count();
  record.beat = 0;
  record.stage.clear();
  record.progress = 0;
}

void ExtractionWatch::disown(const std::string& owner) const {
  live_runs().remove(owner);
}

bool ExtractionWatch::has_certainly_ended(const std::string& owner) const {
  const std::string process = process_of(owner);
  return process == store_.process_name() ? !live_runs().contains(owner) : !store_.may_be_running(process);
}

bool ExtractionWatch::claim(RunRecord& record, const std::string& owner) const {
  if (record.state != RunRecord::State::wanted) return false;
  if (!record.owner.empty() && !has_certainly_ended(record.owner)) return false;
  own(record, owner);
  return true;
}

bool ExtractionWatch::is_over(const RunRecord& record, Watched& watched) const {
  if (record.owner.empty() || has_certainly_ended(record.owner)) return true;
  const auto now = Clock::now();
  if (record.owner != watched.seen_owner || record.beat != watched.seen_beat ||
      watched.seen_at == Clock::time_point{}) {
    watched.seen_owner = record.owner;
    watched.seen_beat = record.beat;
    watched.seen_at = now;
    return false;
  }
  return now - watched.seen_at > std::chrono::milliseconds(record.lease_ms);
}

bool ExtractionWatch::holds(const Extraction& extraction, const std::string& owner) {
  const auto record = records_.read(extraction.identity().id);
  return record && record->owner == owner && record->state == RunRecord::State::wanted;
}

void ExtractionWatch::release(const std::shared_ptr<Extraction>& extraction, const std::string& owner,
                              const Result<void>& outcome) {
  const std::string& id = extraction->identity().id;
  disown(owner);
  if (outcome) {
    // What is left of these when the process dies here does no harm: the manifest is there.
    static_cast<void>(store_.remove(key(*extraction, kEarlyLevels)));
    static_cast<void>(records_.remove(id));
    return;
  }
  const bool has_failed = outcome.error().code != ErrorCode::cancelled;
  bool was_ours = false;
  const auto left = records_.update(id, [&](RunRecord& record) {
    was_ours = record.owner == owner;
    if (!was_ours) return false;
    record.owner.clear();
    if (has_failed && record.state == RunRecord::State::wanted) {
      record.state = RunRecord::State::failed;
      record.error = outcome.error();
    }
    return true;
  });
  const auto place = watched(*extraction);
  if (place) {
    const std::lock_guard lock(place->mutex);
    place->owner.clear();
  }
  const bool is_lost = left && !was_ours && left->state == RunRecord::State::wanted && !extraction->is_cancelled() &&
                       exists(*extraction, kRequest);
  if (!is_lost || !place) extraction->fail(outcome.error());
}

// ---- watching

void ExtractionWatch::add(const std::shared_ptr<Extraction>& extraction, const std::string& owner) {
  const std::lock_guard lock(mutex_);
  watched_[extraction.get()] = std::make_shared<Watched>(extraction, owner);
  has_news_ = true;
  if (!thread_.joinable()) thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  changed_.notify_all();
}

std::shared_ptr<ExtractionWatch::Watched> ExtractionWatch::watched(const Extraction& extraction) {
  const std::lock_guard lock(mutex_);
  const auto found = watched_.find(&extraction);
  return found == watched_.end() ? nullptr : found->second;
}

void ExtractionWatch::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    std::map<const Extraction*, std::shared_ptr<Watched>> all;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, stop, [&] { return !watched_.empty(); });
      has_news_ = false;
      all = watched_;
    }
    for (const auto& [which, one] : all) {
      if (stop.stop_requested()) return;
      if (look_at(*one)) continue;
      const std::lock_guard lock(mutex_);
      const auto found = watched_.find(which);
      if (found != watched_.end() && found->second == one) watched_.erase(found);
    }
    all.clear();
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, stop, timing_.tick, [&] { return has_news_; });
  }
}

bool ExtractionWatch::look_at(Watched& watched) {
  const auto extraction = watched.extraction.lock();
  if (!extraction || extraction->has_ended()) return false;
  withdraw_abandoned(*extraction);
  const std::lock_guard lock(watched.mutex);
  return watched.owner.empty() ? follow_one(extraction, watched) : renew_one(extraction, watched);
}

void ExtractionWatch::withdraw_abandoned(Extraction& extraction) {
  const int abandoned = extraction.take_abandoned();
  if (abandoned == 0) return;
  const auto record = records_.update(extraction.identity().id, [&](RunRecord& changed) {
    changed.withdraw(abandoned);
    return true;
  });
  if (record && record->state == RunRecord::State::cancelled) extraction.cancel();
}

bool ExtractionWatch::follow_one(const std::shared_ptr<Extraction>& extraction, Watched& watched) {
  if (exists(*extraction, kManifest)) {
    if (auto manifest = read(*extraction, kManifest)) {
      extraction->complete(*manifest, std::nullopt, empty_because(*extraction, *manifest));
      return false;
    }
  }
  const auto record = records_.read(extraction->identity().id);
  if (!record) return true;  // the store may recover
  if (record->state == RunRecord::State::cancelled || !exists(*extraction, kRequest)) {
    extraction->fail(cancelled());
    return false;
  }
  if (record->state == RunRecord::State::failed) {
    extraction->fail(record->error.value_or(Error{ErrorCode::internal, "it failed"}));
    return false;
  }
  if (record->levels > watched.published) {
    read_levels(*extraction);
    watched.published = record->levels;
  }
  if (is_over(*record, watched))
    take_over(extraction, watched);
  else if (!record->stage.empty())
    extraction->report(record->stage.c_str(), record->progress);
  return true;
}

void ExtractionWatch::take_over(const std::shared_ptr<Extraction>& extraction, Watched& watched) {
  const std::string owner = new_owner();
  const std::string& id = extraction->identity().id;
  const auto record = records_.update(id, [&](RunRecord& changed) {
    if (changed.state != RunRecord::State::wanted || !is_over(changed, watched)) return false;
    own(changed, owner);
    return true;
  });
  if (!record || record->owner != owner) return disown(owner);
  watched.owner = owner;
  watched.published = 0;  // told of again, as they are stored again
  watched.renewed = Clock::now();
  if (start_(extraction, owner)) return;
  watched.owner.clear();
  disown(owner);
  static_cast<void>(records_.update(id, [&](RunRecord& changed) {
    if (changed.owner != owner) return false;
    changed.owner.clear();
    return true;
  }));
}

bool ExtractionWatch::renew_one(const std::shared_ptr<Extraction>& extraction, Watched& watched) {
  const auto record = records_.read(extraction->identity().id);
  if (!record) return true;
  if (record->owner != watched.owner) {
    // Taken over by others while this process stood still; done by them; or removed.
    watched.owner.clear();
    if (exists(*extraction, kRequest))
      extraction->stop_work();
    else
      extraction->cancel();
    return true;
  }
  if (record->state == RunRecord::State::cancelled) {
    extraction->cancel();
    return true;
  }
  renew_lease(*extraction, watched);
  return true;
}

void ExtractionWatch::renew_lease(Extraction& extraction, Watched& watched) {
  const Extraction::Snapshot now = extraction.snapshot();
  const bool has_levels = now.levels.size() > watched.published;
  if (!has_levels && Clock::now() - watched.renewed < timing_.lease / kRenewals) return;
  if (has_levels) {
    const std::string text = document_text(now.levels);
    if (!store_.put(key(extraction, kEarlyLevels), bytes_of(text))) return;  // tried again at the next look
  }
  const auto record = records_.update(extraction.identity().id, [&](RunRecord& changed) {
    if (changed.owner != watched.owner) return false;
    ++changed.beat;
    changed.levels = now.levels.size();
    changed.stage = now.stage;
    changed.progress = now.progress;
    return true;
  });
  if (!record) return;
  watched.renewed = Clock::now();
  watched.published = now.levels.size();
}

void ExtractionWatch::read_levels(Extraction& extraction) {
  const auto levels = read(extraction, kEarlyLevels);
  if (!levels || !levels->is_array()) return;
  for (const Json& level : *levels) extraction.add_level(level);
}

}  // namespace geosis::server
