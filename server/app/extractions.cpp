#include "server/app/extractions.h"

#include <utility>

#include "server/app/extraction_blobs.h"
#include "server/documents/ids.h"
#include "server/documents/request.h"
#include "server/documents/request_check.h"

namespace geosis::server {
namespace {

constexpr std::size_t kMostEntries = 512;
constexpr std::chrono::milliseconds kLongestStop = std::chrono::seconds(10);

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

Error no_such_extraction(const std::string& id) {
  return {ErrorCode::not_found, "extraction " + id + ": there is no such extraction"};
}

/// Volumes that an extraction was computed from: when one of them goes, so does the result.
std::vector<std::string> volumes_of(const Extraction::Identity& identity) {
  std::vector<std::string> volumes{identity.volume};
  const Json other = identity.request.value("attribute_volume", Json(nullptr));
  if (other.is_string()) volumes.push_back(other.get<std::string>());
  return volumes;
}

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

/// Failed, cancelled, or about to be: another POST starts anew.
bool ends_without_result(const Extraction& extraction) {
  const JobState state = extraction.snapshot().state;
  return state == JobState::failed || state == JobState::cancelled || extraction.is_ending();
}

/// The parts of a transient extraction, kept in memory.
class PartShelf {
 public:
  void put(int level, int part, std::span<const std::byte> bytes) {
    const std::lock_guard lock(mutex_);
    parts_[{level, part}].assign(bytes.begin(), bytes.end());
  }
  Result<std::vector<std::byte>> get(int level, int part) const {
    const std::lock_guard lock(mutex_);
    const auto found = parts_.find({level, part});
    if (found == parts_.end()) return Error{ErrorCode::not_found, part_name(level, part) + ": there is no such part"};
    return found->second;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::pair<int, int>, std::vector<std::byte>> parts_;
};

}  // namespace

/// An id's place in the table. The mutex serialises whoever starts or loads it, so that it happens once.
struct Extractions::Entry {
  std::mutex mutex;
  std::shared_ptr<Extraction> extraction;
};

Extractions::Extractions(BlobStore& store, Volumes& volumes, JobQueue& queue, std::string tenant, int threads,
                         ReconstructFunction reconstruct)
    : store_(store),
      volumes_(volumes),
      queue_(queue),
      tenant_(std::move(tenant)),
      threads_(threads),
      reconstruct_(std::move(reconstruct)),
      fills_(store, tenant_, threads) {}

Result<Json> Extractions::read_document(const std::string& id, const char* name) const {
  if (!is_id(id)) return no_such_extraction(id);
  auto bytes = store_.get(key(id, name));
  if (!bytes) return bytes.error().code == ErrorCode::not_found ? no_such_extraction(id) : bytes.error();
  return parse_json({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
}

Result<void> Extractions::write_document(const BlobKey& key, const Json& document) {
  return store_.put(key, bytes_of(document_text(document)));
}

PartReader Extractions::part_reader(const std::string& id) const {
  return [this, id](int level, int part) { return store_.get(key(id, part_name(level, part))); };
}

std::shared_ptr<Extractions::Entry> Extractions::entry_of(const std::string& id) {
  const std::lock_guard lock(mutex_);
  if (entries_.size() >= kMostEntries) {
    std::erase_if(entries_, [](const auto& entry) {
      const auto& held = entry.second;
      return held.use_count() == 1 && (!held->extraction || is_final(held->extraction->snapshot().state));
    });
  }
  auto& entry = entries_[id];
  if (!entry) entry = std::make_shared<Entry>();
  return entry;
}

// ---- starting

Result<std::shared_ptr<Extraction>> Extractions::create(const std::string& volume, const Json& request,
                                                        Priority priority) {
  const auto stored = volumes_.open(volume);
  if (!stored) return stored.error();
  auto options = parse_request(request);
  if (!options) return std::move(options).error();
  const VolumeSummary& summary = (*stored)->summary;
  if (auto checked = check_request(*options, summary); !checked) return std::move(checked).error();
  if (auto other = open_attribute_volume(*options, summary); !other) return std::move(other).error();
  Json canonical = request_document(*options, summary.shape);
  const std::string id = extraction_id(volume, canonical, kResultVersion);

  const auto entry = entry_of(id);
  const std::lock_guard lock(entry->mutex);
  if (!entry->extraction) {
    auto loaded = load(*entry, id);
    if (!loaded && loaded.error().code != ErrorCode::not_found) return loaded;
  }
  const bool is_usable = entry->extraction && !ends_without_result(*entry->extraction);
  if (is_usable && entry->extraction->add_interest()) return entry->extraction;
  auto started = record_and_start(*entry, {id, volume, timestamp(), std::move(canonical)}, priority);
  if (started) (*started)->add_interest();
  return started;
}

/// A place in the queue first: a request that is refused leaves no record. The request is durable before anybody is
/// told of it, and before its job goes on.
Result<std::shared_ptr<Extraction>> Extractions::record_and_start(Entry& entry, Extraction::Identity identity,
                                                                  Priority priority) {
  auto extraction = std::make_shared<Extraction>(identity, part_reader(identity.id));
  std::promise<bool> recorded;
  if (auto started = start(extraction, priority, recorded.get_future().share()); !started) {
    return std::move(started).error();
  }
  auto done = record(identity);
  recorded.set_value(done.has_value());
  if (!done) return std::move(done).error();
  return entry.extraction = std::move(extraction);
}

Result<void> Extractions::record(const Extraction::Identity& identity) {
  const Json record = {{"id", identity.id},
                       {"volume", identity.volume},
                       {"result_version", kResultVersion},
                       {"created_at", identity.created_at},
                       {"request", identity.request}};
  for (const std::string& volume : volumes_of(identity)) {
    if (auto done = write_document(result_key(volume, identity.id), Json::object()); !done) return done;
  }
  if (auto done = write_document(key(identity.id, kRequest), record); !done) return done;
  const auto done = store_.remove(key(identity.id, kCancelled));
  return !done && done.error().code != ErrorCode::not_found ? done : Result<void>{};
}

Result<void> Extractions::start(std::shared_ptr<Extraction> extraction, Priority priority,
                                std::shared_future<bool> recorded) {
  auto job = queue_.submit(priority, [this, extraction, recorded](Job& running) -> Result<void> {
    if (!recorded.get()) return Error{ErrorCode::cancelled, "the request could not be recorded"};
    return run(*extraction, running);
  });
  if (!job) return std::move(job).error();
  extraction->set_job(*std::move(job));
  return {};
}

Result<void> Extractions::run(Extraction& extraction, Job& job) {
  const auto& identity = extraction.identity();
  ExtractionTimings timings;
  const auto opened = open(identity, job, timings);
  if (!opened) return opened.error();
  const PartWriter write_part = [&](int level, int part, std::span<const std::byte> bytes) {
    return store_.put(key(identity.id, part_name(level, part)), bytes);
  };
  auto manifest =
      compute_extraction(extraction, opened->input(), opened->options, reconstruct_, write_part, job, timings);
  if (!manifest) return std::move(manifest).error();
  if (auto done = write_document(key(identity.id, kManifest), *manifest); !done) return done;
  extraction.complete(*std::move(manifest), timings);
  return {};
}

ExtractionInput Extractions::Opened::input() const {
  return {.volume = volume->summary,
          .samples = *volume->samples,
          .filled = filled ? filled->samples.get() : nullptr,
          .attribute_volume = attribute_volume ? attribute_volume->samples.get() : nullptr};
}

Result<Extractions::Opened> Extractions::open(const Extraction::Identity& identity, Progress& progress,
                                              ExtractionTimings& timings) {
  const auto start = Clock::now();
  auto options = parse_request(identity.request);
  if (!options) return std::move(options).error();
  options->threads = threads_;
  auto volume = volumes_.open(identity.volume);
  if (!volume) return std::move(volume).error();
  auto other = open_attribute_volume(*options, (*volume)->summary);
  if (!other) return std::move(other).error();
  timings.load = seconds_since(start);
  auto filled = fill(*volume, *options, progress);
  if (!filled) return std::move(filled).error();
  timings.fill = seconds_since(start) - timings.load;
  return Opened{*std::move(options), *std::move(volume), *std::move(filled), *std::move(other)};
}

/// The volume that the attribute `value` is of; null when the request names none.
Result<std::shared_ptr<const StoredVolume>> Extractions::open_attribute_volume(const ReconstructOptions& options,
                                                                               const VolumeSummary& volume) {
  if (!options.attribute_volume) return std::shared_ptr<const StoredVolume>();
  auto other = volumes_.open(*options.attribute_volume);
  if (!other) return Error{other.error().code, "request /attribute_volume: " + other.error().message};
  if (auto fits = check_attribute_volume((*other)->summary, volume); !fits) return std::move(fits).error();
  return other;
}

/// Null when nothing is to be filled.
Result<std::shared_ptr<const FilledStoredVolume>> Extractions::fill(std::shared_ptr<const StoredVolume> volume,
                                                                    const ReconstructOptions& options,
                                                                    Progress& progress) {
  if (options.fill.method == FillMethod::none || !has_missing(*volume->samples)) {
    return std::shared_ptr<const FilledStoredVolume>();
  }
  return fills_.fill(std::move(volume), options.fill, progress);
}

Result<std::shared_ptr<Extraction>> Extractions::create_transient(const ByteSource& file, const UploadOptions& upload,
                                                                  const Json& request, Progress& progress,
                                                                  std::vector<GridCandidate>& candidates) {
  auto options = parse_request(request);
  if (!options) return std::move(options).error();
  if (options->attribute_volume) {
    return Error{ErrorCode::unsupported, "request /attribute_volume: a one-shot call has no other volume"};
  }
  options->threads = threads_;
  auto imported = import_volume(file, upload.import, std::nullopt, progress, &candidates);
  if (!imported) return std::move(imported).error();
  const auto volume = std::make_shared<const ImportedVolume>(*std::move(imported));
  const auto shelf = std::make_shared<PartShelf>();
  const VolumeSummary summary = summarize(volume->description);
  if (auto checked = check_request(*options, summary); !checked) return std::move(checked).error();
  Json canonical = request_document(*options, summary.shape);
  const std::string id = extraction_id(summary.id, canonical, kResultVersion);
  auto extraction =
      std::make_shared<Extraction>(Extraction::Identity{id, summary.id, timestamp(), std::move(canonical)},
                                   [shelf](int level, int part) { return shelf->get(level, part); });
  auto job =
      queue_.submit(Priority::interactive, [=, this, weak = std::weak_ptr(extraction)](Job& running) -> Result<void> {
        const auto held = weak.lock();
        if (!held) return Error{ErrorCode::cancelled, "nobody waits for it any more"};
        const PartWriter write_part = [&](int level, int part, std::span<const std::byte> bytes) -> Result<void> {
          shelf->put(level, part, bytes);
          return {};
        };
        ExtractionTimings timings;
        auto manifest = compute_extraction(*held, {.volume = summary, .samples = *volume->samples}, *options,
                                           reconstruct_, write_part, running, timings);
        if (!manifest) return std::move(manifest).error();
        held->complete(*std::move(manifest), timings);
        return {};
      });
  if (!job) return std::move(job).error();
  extraction->set_job(*std::move(job));
  extraction->add_interest();
  return extraction;
}

// ---- finding

Result<std::shared_ptr<Extraction>> Extractions::find(const std::string& id) {
  if (!is_id(id)) return no_such_extraction(id);
  const auto entry = entry_of(id);
  const std::lock_guard lock(entry->mutex);
  if (entry->extraction) return entry->extraction;
  return load(*entry, id);
}

/// From the store: done, cancelled, or only asked for, perhaps of a replica that died: then it is computed here.
Result<std::shared_ptr<Extraction>> Extractions::load(Entry& entry, const std::string& id) {
  const auto record = read_document(id, kRequest);
  if (!record) return record.error();
  auto extraction = std::make_shared<Extraction>(
      Extraction::Identity{id, record->at("volume").get<std::string>(), record->at("created_at").get<std::string>(),
                           record->at("request")},
      part_reader(id));
  if (auto manifest = read_document(id, kManifest)) {
    extraction->complete(*std::move(manifest), std::nullopt);
  } else if (const auto cancelled = store_.exists(key(id, kCancelled)); cancelled && *cancelled) {
    extraction->set_cancelled();
  } else if (record->at("result_version").get<int>() != kResultVersion) {
    return Error{ErrorCode::unavailable, "extraction " + id + ": asked of result version " +
                                             record->at("result_version").dump() + "; this is version " +
                                             std::to_string(kResultVersion)};
  } else {
    std::promise<bool> recorded;
    recorded.set_value(true);
    auto started = start(extraction, Priority::interactive, recorded.get_future().share());
    if (!started) return std::move(started).error();
  }
  return entry.extraction = std::move(extraction);
}

// ---- ending

Result<void> Extractions::withdraw(const std::string& id) {
  if (!is_id(id)) return no_such_extraction(id);
  const auto entry = entry_of(id);
  const std::lock_guard lock(entry->mutex);  // a POST in between starts it anew
  if (!entry->extraction) {
    if (auto loaded = load(*entry, id); !loaded) return std::move(loaded).error();
  }
  if (!entry->extraction->withdraw_interest()) return {};
  const auto done = write_document(key(id, kCancelled), {{"cancelled_at", timestamp()}});
  entry->extraction->cancel();
  return done;
}

void Extractions::abandon(Extraction& extraction) {
  if (extraction.withdraw_interest()) extraction.cancel();
}

Result<void> Extractions::purge(const std::string& id) {
  const auto record = read_document(id, kRequest);
  if (!record) return record.error();
  if (auto done = remove_blobs(id); !done) return done;
  const Extraction::Identity identity{id, record->at("volume").get<std::string>(), "", record->at("request")};
  for (const std::string& volume : volumes_of(identity)) {
    if (auto done = store_.remove(result_key(volume, id)); !done) return done;
  }
  return {};
}

/// Removes what is stored of an extraction, whether or not it has a record. What computes it is stopped first, or it
/// would go on storing parts.
Result<void> Extractions::remove_blobs(const std::string& id) {
  const auto entry = entry_of(id);
  const std::lock_guard lock(entry->mutex);
  if (entry->extraction) {
    entry->extraction->cancel();
    entry->extraction->wait_for(kLongestStop);
    entry->extraction.reset();
  }
  // The manifest first: what is left is then no result any more. The record last: until then the rest can be found.
  if (auto done = store_.remove(key(id, kManifest)); !done) return done;
  for (;;) {
    const auto keys = store_.list(key(id, ""), "", 1000);
    if (!keys) return keys.error();
    const BlobKey record = key(id, kRequest);
    const bool is_last = keys->size() <= 1;
    for (const BlobKey& left : *keys) {
      if (left == record && !is_last) continue;
      if (auto done = store_.remove(left); !done) return done;
    }
    if (is_last) return {};
  }
}

Result<void> Extractions::purge_results_of(const std::string& volume) {
  const auto ids = store_.children(result_key(volume, ""));
  if (!ids) return ids.error();
  for (const std::string& id : *ids) {
    if (auto done = remove_blobs(id); !done) return done;
    if (auto done = store_.remove(result_key(volume, id)); !done) return done;
  }
  return fills_.remove(volume);
}

}  // namespace geosis::server
