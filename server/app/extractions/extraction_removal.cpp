#include "server/app/extractions/extraction_blobs.h"
#include "server/app/extractions/extraction_identity.h"
#include "server/app/extractions/extractions.h"
#include "server/app/volumes/volume_blobs.h"

// What ends and removes extractions, and what is left when that is cut short.

namespace geosis::server {
namespace {

constexpr std::chrono::milliseconds kLongestStop = std::chrono::seconds(10);

}  // namespace

Result<void> Extractions::withdraw(const std::string& id) {
  if (!is_id(id)) return no_such_extraction(id);
  const auto entry = entry_of(id);
  const std::lock_guard lock(entry->mutex);  // a POST in between starts it anew
  drop_outdated(*entry);
  if (!entry->extraction) {
    if (auto loaded = load(*entry, id); !loaded) return std::move(loaded).error();
  }
  if (entry->extraction->has_ended()) return {};
  const auto record = records_.update(id, [](RunRecord& changed) {
    if (changed.state != RunRecord::State::wanted) return false;
    changed.withdraw(1);
    return true;
  });
  if (!record) return record.error();
  if (record->state != RunRecord::State::cancelled) return {};
  const auto is_done = store_.exists(key(id, kManifest));
  if (is_done && *is_done) return records_.remove(id);  // it came to its end meanwhile
  entry->extraction->cancel();
  return {};
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
  const auto told = records_.update(id, [](RunRecord& changed) {
    if (changed.owner.empty()) return false;
    changed.state = RunRecord::State::cancelled;
    return true;
  });
  if (!told) return told.error();
  if (entry->extraction) {
    entry->extraction->cancel();
    entry->extraction->wait_for_work(kLongestStop);
    entry->extraction.reset();
  }
  if (auto done = remove_leftovers(id); !done) return done;
  if (auto done = records_.remove(id); !done) return done;
  return store_.remove(key(id, kRequest));
}

/// All but the records. The manifest first: what is left is then no result any more.
Result<void> Extractions::remove_leftovers(const std::string& id) {
  if (auto done = store_.remove(key(id, kManifest)); !done) return done;
  const auto blobs = store_.inventory(key(id, ""));
  if (!blobs) return blobs.error();
  for (const BlobInfo& left : *blobs) {
    if (left.key == key(id, kRequest) || left.key == key(id, kRun)) continue;
    if (auto done = store_.remove(left.key); !done) return done;
  }
  return {};
}

Result<void> Extractions::purge_results_of(const std::string& volume) {
  const auto ids = store_.children(result_key(volume, ""));
  if (!ids) return ids.error();
  for (const std::string& id : *ids) {
    if (auto done = remove_blobs(id); !done) return done;
    if (auto done = store_.remove(result_key(volume, id)); !done) return done;
  }
  if (auto done = structures_.remove(volume); !done) return done;
  return fills_.remove(volume);
}

Result<void> Extractions::purge_results_on(const std::string& volume, const std::string& grid) {
  const auto ids = store_.children(result_key(volume, ""));
  if (!ids) return ids.error();
  for (const std::string& id : *ids) {
    const auto record = read_document(id, kRequest);
    if (!record || record->at("volume") != volume || record->at("request").value("grid", Json()) != grid) continue;
    if (auto done = purge(id); !done && done.error().code != ErrorCode::not_found) return done;
  }
  return {};
}

Result<void> Extractions::collect_garbage() {
  const auto ids = store_.children(tenant_ + "/extractions/");
  if (!ids) return ids.error();
  for (const std::string& id : *ids) {
    if (auto done = collect_garbage_of(id); !done) return done;
  }
  const auto volumes = store_.children(tenant_ + "/volumes/");
  if (!volumes) return volumes.error();
  for (const std::string& volume : *volumes) {
    const auto is_there = store_.exists(tenant_ + "/volumes/" + volume + "/" + kVolume);
    if (!is_there || *is_there) continue;
    if (auto done = purge_results_of(volume); !done) return done;
  }
  return {};
}

/// What is stored of an extraction without a request, unless somebody still computes it: then it is his to remove.
Result<void> Extractions::collect_garbage_of(const std::string& id) {
  const auto is_recorded = store_.exists(key(id, kRequest));
  if (!is_recorded || *is_recorded) return {};
  const auto run = records_.read(id);
  if (!run || (!run->owner.empty() && store_.may_be_running(process_of(run->owner)))) return {};
  if (auto done = remove_leftovers(id); !done) return done;
  return records_.remove(id);
}

}  // namespace geosis::server
