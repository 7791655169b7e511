#include "server/app/extractions/extractions.h"

#include <utility>

#include "server/app/extractions/demand.h"
#include "server/app/extractions/extraction_blobs.h"
#include "server/app/extractions/extraction_identity.h"
#include "server/app/volumes/volume_blobs.h"
#include "server/documents/ids.h"
#include "server/documents/request.h"
#include "server/documents/request_check.h"

namespace geosis::server {
namespace {

constexpr std::size_t kMostEntries = 512;

}  // namespace

Extractions::Extractions(BlobStore& store, Volumes& volumes, JobQueue& queue, std::string tenant, int threads,
                         ReconstructFunction reconstruct, WatchTiming timing)
    : store_(store),
      volumes_(volumes),
      queue_(queue),
      tenant_(std::move(tenant)),
      threads_(threads),
      reconstruct_(std::move(reconstruct)),
      fills_(store, tenant_, threads),
      structures_(store, tenant_, threads),
      records_(store, tenant_),
      watch_(store, records_, tenant_, timing, [this](const auto& extraction, const std::string& owner) {
        std::promise<bool> recorded;
        recorded.set_value(true);
        return submit(extraction, owner, Priority::interactive, recorded.get_future().share()).has_value();
      }) {}

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
  return [this, id](int level, int part) {
    store_.touch(key(id, kManifest));
    auto bytes = store_.get(key(id, part_name(level, part)));
    // A finished result without all of its parts is none.
    if (!bytes && bytes.error().code != ErrorCode::unavailable) discard_result(id);
    return bytes;
  };
}

std::shared_ptr<Extractions::Entry> Extractions::entry_of(const std::string& id) {
  const std::lock_guard lock(mutex_);
  if (entries_.size() >= kMostEntries) {
    std::erase_if(entries_, [](const auto& entry) {
      const auto& held = entry.second;
      return held.use_count() == 1 && (!held->extraction || held->extraction->has_ended());
    });
  }
  auto& entry = entries_[id];
  if (!entry) entry = std::make_shared<Entry>();
  return entry;
}

// ---- starting

Result<Extractions::Wanted> Extractions::check(const std::string& volume, const Json& request) {
  auto stored = volumes_.open(volume);
  if (!stored) return std::move(stored).error();
  auto options = parse_request(request);
  if (!options) return std::move(options).error();
  const VolumeSummary& summary = (*stored)->summary;
  if (auto checked = check_request(*options, summary); !checked) return std::move(checked).error();
  if (auto checked = check_grid(*options, summary); !checked) return std::move(checked).error();
  if (auto other = open_attribute_volume(*options, summary); !other) return std::move(other).error();
  options->threads = threads_;
  return Wanted{*std::move(options), *std::move(stored)};
}

Result<Json> Extractions::estimate(const std::string& volume, const Json& request) {
  const auto wanted = check(volume, request);
  if (!wanted) return wanted.error();
  return estimate_document(estimate_reconstruction(*wanted->volume->samples, wanted->options));
}

JobDemand Extractions::demand_of(const BrickedVolume& samples, const ReconstructOptions& options,
                                 Priority priority) const {
  return {.priority = options.preview ? Priority::preview : priority,
          .memory_bytes = memory_to_reserve(estimate_reconstruction(samples, options)),
          .tenant = tenant_,
          .what = "extraction that is not kept"};
}

/// Of what cannot be opened only the priority is known: its job will fail at once.
JobDemand Extractions::demand_of(const Extraction::Identity& identity, Priority priority) {
  auto options = parse_request(identity.request);
  const auto volume = volumes_.open(identity.volume);
  JobDemand demand{.priority = priority, .tenant = tenant_};
  if (options && volume) {
    options->threads = threads_;
    demand = demand_of(*(*volume)->samples, *options, priority);
  }
  demand.what = "extraction " + identity.id;
  return demand;
}

Result<std::shared_ptr<Extraction>> Extractions::create(const std::string& volume, const Json& request,
                                                        Priority priority, const std::string& asked_by) {
  const auto wanted = check(volume, request);
  if (!wanted) return wanted.error();
  Json canonical = request_document(wanted->options, wanted->volume->summary.shape);
  const std::string id = extraction_id(volume, canonical, kResultVersion);

  const auto entry = entry_of(id);
  const std::lock_guard lock(entry->mutex);
  const auto is_recorded = load_for_create(*entry, id);
  if (!is_recorded) return is_recorded.error();
  if (*is_recorded) {
    const auto has_joined = join(*entry);
    if (!has_joined) return has_joined.error();
    if (*has_joined) {
      if (events_.asked) events_.asked(true);
      return entry->extraction;
    }
  }
  if (events_.asked) events_.asked(false);
  return record_and_start(*entry, {id, volume, timestamp(), std::move(canonical), asked_by}, *is_recorded, priority);
}

/// Brings the entry up to date. True when the request is recorded already; what is damaged is forgotten and made anew.
Result<bool> Extractions::load_for_create(Entry& entry, const std::string& id) {
  drop_outdated(entry);
  if (entry.extraction) return true;
  auto loaded = load(entry, id);
  if (!loaded && loaded.error().code == ErrorCode::internal) {
    discard_result(id);
    loaded = load(entry, id);
  }
  if (loaded) return true;
  const ErrorCode code = loaded.error().code;
  if (code != ErrorCode::not_found && code != ErrorCode::internal) return std::move(loaded).error();
  return false;
}

Result<bool> Extractions::join(Entry& entry) {
  const Extraction& known = *entry.extraction;
  if (known.is_done()) return true;
  if (known.has_ended() || known.is_cancelled()) return false;
  const auto record = records_.update(known.identity().id, [&](RunRecord& changed) {
    if (changed.state != RunRecord::State::wanted || changed.owner.empty()) return false;
    ++changed.interest;
    return true;
  });
  if (!record) return record.error();
  return record->state == RunRecord::State::wanted && !record->owner.empty();
}

/// A place in the queue first: a request that is refused leaves no record. The request is durable before anybody is
/// told of it, and before its job goes on.
Result<std::shared_ptr<Extraction>> Extractions::record_and_start(Entry& entry, Extraction::Identity identity,
                                                                  bool is_recorded, Priority priority) {
  const std::string id = identity.id, owner = watch_.new_owner();
  auto extraction = std::make_shared<Extraction>(identity, part_reader(id));
  std::promise<bool> recorded;
  if (auto queued = submit(extraction, owner, priority, recorded.get_future().share()); !queued) {
    return std::move(queued).error();
  }
  auto done = is_recorded ? Result<void>{} : record_request(identity);
  Result<bool> is_ours = done ? record_interest(id, owner) : Result<bool>(done.error());
  if (is_ours && *is_ours) watch_.renew(extraction, owner);
  if (!is_ours || !*is_ours) watch_.disown(owner);
  recorded.set_value(is_ours && *is_ours);
  if (!is_ours) {
    if (!is_recorded) static_cast<void>(store_.remove(key(id, kRequest)));
    return std::move(is_ours).error();
  }
  if (!*is_ours) watch_.follow(extraction);  // somebody else was first, or still stops
  return entry.extraction = std::move(extraction);
}

Result<void> Extractions::record_request(const Extraction::Identity& identity) {
  const Json record = {{"id", identity.id},
                       {"volume", identity.volume},
                       {"result_version", kResultVersion},
                       {"created_at", identity.created_at},
                       {"request", identity.request}};
  discard_result(identity.id);  // of a run that ended after its request was removed
  for (const std::string& volume : volumes_of(identity)) {
    if (auto done = write_document(result_key(volume, identity.id), Json::object()); !done) return done;
  }
  return write_document(key(identity.id, kRequest), record);
}

/// True when the lease is the owner's.
Result<bool> Extractions::record_interest(const std::string& id, const std::string& owner) {
  const auto record = records_.update(id, [&](RunRecord& changed) {
    if (changed.state != RunRecord::State::wanted) {
      changed.state = RunRecord::State::wanted;
      changed.interest = 0;
      changed.error.reset();
    }
    ++changed.interest;
    watch_.claim(changed, owner);
    return true;
  });
  if (!record) return record.error();
  return record->owner == owner;
}

// ---- finding

Result<std::shared_ptr<Extraction>> Extractions::find(const std::string& id) {
  if (!is_id(id)) return no_such_extraction(id);
  const auto entry = entry_of(id);
  const std::lock_guard lock(entry->mutex);
  drop_outdated(*entry);
  if (entry->extraction) return entry->extraction;
  return load(*entry, id);
}

/// What has ended is as the store says: another server may have removed it, or started it again.
void Extractions::drop_outdated(Entry& entry) const {
  if (!entry.extraction || !entry.extraction->has_ended()) return;
  const auto is_done = store_.exists(key(entry.extraction->identity().id, kManifest));
  if (!entry.extraction->is_done() || (is_done && !*is_done)) entry.extraction.reset();
}

/// From the store: done, ended otherwise, or only asked for; that is followed, and computed here if nobody does.
Result<std::shared_ptr<Extraction>> Extractions::load(Entry& entry, const std::string& id) {
  const auto record = read_document(id, kRequest);
  if (!record) return record.error();
  auto extraction = std::make_shared<Extraction>(
      Extraction::Identity{id, record->at("volume").get<std::string>(), record->at("created_at").get<std::string>(),
                           record->at("request")},
      part_reader(id));
  auto manifest = read_document(id, kManifest);
  if (manifest) {
    extraction->complete(*manifest, std::nullopt, watch_.empty_because(*extraction, *manifest));
    return entry.extraction = std::move(extraction);
  }
  if (manifest.error().code != ErrorCode::not_found) return std::move(manifest).error();
  const auto run = records_.read(id);
  if (!run) return run.error();
  if (run->state == RunRecord::State::cancelled) {
    extraction->fail({ErrorCode::cancelled, "cancelled"});
  } else if (run->state == RunRecord::State::failed) {
    extraction->fail(run->error.value_or(Error{ErrorCode::internal, "it failed"}));
  } else if (record->at("result_version").get<int>() != kResultVersion) {
    return Error{ErrorCode::unavailable, "extraction " + id + ": asked of result version " +
                                             record->at("result_version").dump() + "; this is version " +
                                             std::to_string(kResultVersion)};
  } else {
    watch_.follow(extraction);
  }
  return entry.extraction = std::move(extraction);
}

/// A manifest whose parts are gone or damaged. It is computed again when somebody asks for it.
void Extractions::discard_result(const std::string& id) const {
  const auto is_there = store_.exists(key(id, kManifest));
  if (is_there && *is_there) static_cast<void>(store_.remove(key(id, kManifest)));
}

}  // namespace geosis::server
