#include "server/app/derived/fills.h"

#include <utility>

#include "engine/pipeline/reconstruct.h"
#include "server/documents/request_sections.h"

namespace geosis::server {
namespace {

constexpr std::size_t kRecentFills = 4;

/// "2-rbf-polyharmonic-auto-12.5": the canonical choice as a name in the store.
std::string name_of_fill(const FillOptions& options) {
  const Json choice = missing_document(options);
  std::string name = std::to_string(kResultVersion);
  for (const char* field : {"method", "kernel", "steer"}) name += "-" + choice.at(field).get<std::string>();
  std::string distance = choice.at("max_distance").is_null() ? "all" : canonical_text(choice.at("max_distance"));
  std::erase(distance, '+');  // of an exponent
  return name + "-" + distance;
}

}  // namespace

Fills::Fills(BlobStore& store, std::string tenant, int threads)
    : store_(store), tenant_(std::move(tenant)), threads_(threads) {}

Result<std::shared_ptr<const FilledStoredVolume>> Fills::fill(std::shared_ptr<const StoredVolume> volume,
                                                              const FillOptions& options, Progress& progress) {
  const BlobKey key = folder(volume->summary.id) + name_of_fill(options);
  KeyTurns::Turn turn;
  if (!turn.take(turns_, key, progress)) return Error{ErrorCode::cancelled, "filling missing samples was cancelled"};
  if (auto known = recent(key)) return known;
  store_.touch(key);
  auto samples = load_or_fill(key, *volume->samples, options, progress);
  if (!samples) return std::move(samples).error();
  auto filled = std::make_shared<const FilledStoredVolume>(FilledStoredVolume{std::move(volume), *std::move(samples)});
  remember(key, filled);
  return filled;
}

std::shared_ptr<const FilledStoredVolume> Fills::recent(const BlobKey& key) {
  const std::lock_guard lock(mutex_);
  for (auto entry = recent_.begin(); entry != recent_.end(); ++entry) {
    if (entry->key != key) continue;
    const auto path = store_.local_file(key);
    if (!path || identity_of(*path) != entry->identity) {  // removed, or written to by others
      recent_.erase(entry);
      return nullptr;
    }
    store_.touch(key);
    entry->identity = identity_of(*path);
    recent_.splice(recent_.begin(), recent_, entry);
    return entry->filled;
  }
  return nullptr;
}

void Fills::remember(const BlobKey& key, std::shared_ptr<const FilledStoredVolume> filled) {
  const auto path = store_.local_file(key);
  if (!path) return;
  const std::lock_guard lock(mutex_);
  recent_.push_front({key, std::move(filled), identity_of(*path)});
  if (recent_.size() > kRecentFills) recent_.pop_back();
}

/// A stored file that does not open, damaged or of another program, is only derived: it is made again.
Result<std::unique_ptr<FilledVolume>> Fills::load_or_fill(const BlobKey& key, const BrickedVolume& samples,
                                                          const FillOptions& options, Progress& progress) {
  if (const auto path = store_.local_file(key)) {
    auto stored = open_fill_file(samples, *path);
    if (stored) return stored;
    store_.report_damage(key, stored.error().message);
  }
  if (auto filled = fill_into_store(key, samples, options, progress); !filled) return std::move(filled).error();
  const auto path = store_.local_file(key);
  if (!path) return path.error();
  return open_fill_file(samples, *path);
}

Result<void> Fills::fill_into_store(const BlobKey& key, const BrickedVolume& samples, const FillOptions& options,
                                    Progress& progress) {
  auto staged = store_.stage();
  if (!staged) return std::move(staged).error();
  if (auto filled = fill_missing(samples, options, (*staged)->path(), threads_, progress); !filled) {
    return std::move(filled).error();
  }
  return store_.commit(*std::move(staged), key);
}

Result<void> Fills::remove(const std::string& volume) {
  {
    const std::lock_guard lock(mutex_);
    recent_.remove_if([&](const Recent& entry) { return entry.filled->volume->summary.id == volume; });
  }
  return remove_children(store_, folder(volume));
}

}  // namespace geosis::server
