#include "server/app/derived/structures.h"

#include <utility>

#include "engine/pipeline/grid_stage.h"
#include "engine/structure/grid_file.h"
#include "server/app/volumes/volume_blobs.h"
#include "server/documents/grid_report.h"

namespace geosis::server {
namespace {

constexpr std::size_t kRecentGrids = 2;
const Error kCancelled = {ErrorCode::cancelled, "laying the structural grid was cancelled"};

std::string name_of(const char* what) {
  return std::to_string(kResultVersion) + "-" + what;
}

}  // namespace

Structures::Structures(BlobStore& store, std::string tenant, int threads)
    : store_(store), tenant_(std::move(tenant)), threads_(threads) {}

Result<std::shared_ptr<const StructuralGrid>> Structures::grid(const StoredVolume& volume, Progress& progress) {
  const BlobKey key = folder(volume.summary.id) + name_of("grid");
  KeyTurns::Turn turn;
  if (!turn.take(turns_, key, progress)) return kCancelled;
  store_.touch(key);
  if (auto known = recent(key)) return known;
  auto made = load_or_lay(key, volume, progress);
  if (!made) return std::move(made).error();
  auto grid = std::make_shared<const StructuralGrid>(*std::move(made));
  remember(key, grid);
  return grid;
}

Result<DipReport> Structures::dips(const StoredVolume& volume, Progress& progress) {
  const BlobKey key = folder(volume.summary.id) + name_of("dips.json");
  KeyTurns::Turn turn;
  if (!turn.take(turns_, key, progress)) return kCancelled;
  store_.touch(key);
  if (const auto stored = store_.get(key)) {
    const auto document = parse_json({reinterpret_cast<const char*>(stored->data()), stored->size()});
    const auto report = document ? parse_dips_document(*document) : document.error();
    if (report) return *report;
    store_.report_damage(key, report.error().message);
  }
  const auto report = report_dips(*volume.samples, threads_, progress);
  if (!report) return report.error();
  if (auto kept = store_.put(key, bytes_of(document_text(dips_document(*report)))); !kept)
    return std::move(kept).error();
  return *report;
}

/// The grid in memory, as long as its file is there: what was removed is laid again, to be there for others too.
std::shared_ptr<const StructuralGrid> Structures::recent(const BlobKey& key) {
  const std::lock_guard lock(mutex_);
  for (auto entry = recent_.begin(); entry != recent_.end(); ++entry) {
    if (entry->key != key) continue;
    if (!store_.local_file(key)) {
      recent_.erase(entry);
      return nullptr;
    }
    recent_.splice(recent_.begin(), recent_, entry);
    return entry->grid;
  }
  return nullptr;
}

void Structures::remember(const BlobKey& key, std::shared_ptr<const StructuralGrid> grid) {
  const std::lock_guard lock(mutex_);
  recent_.push_front({key, std::move(grid)});
  if (recent_.size() > kRecentGrids) recent_.pop_back();
}

/// A stored file that does not open is only derived: it is made again.
Result<StructuralGrid> Structures::load_or_lay(const BlobKey& key, const StoredVolume& volume, Progress& progress) {
  if (const auto path = store_.local_file(key)) {
    auto stored = open_grid_file(volume.summary.shape, *path);
    if (stored) return stored;
    store_.report_damage(key, stored.error().message);
  }
  auto laid = lay_structural_grid(*volume.samples, threads_, progress);
  if (!laid) return laid;
  auto staged = store_.stage();
  if (!staged) return std::move(staged).error();
  if (auto written = write_grid_file(*laid, (*staged)->path()); !written) return std::move(written).error();
  if (auto kept = store_.commit(*std::move(staged), key); !kept) return std::move(kept).error();
  return laid;
}

Result<void> Structures::remove(const std::string& volume) {
  {
    const std::lock_guard lock(mutex_);
    recent_.remove_if([&](const Recent& entry) { return entry.key.starts_with(folder(volume)); });
  }
  return remove_children(store_, folder(volume));
}

}  // namespace geosis::server
