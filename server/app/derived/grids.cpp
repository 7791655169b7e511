#include "server/app/derived/grids.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "server/app/volumes/volume_blobs.h"
#include "server/app/volumes/volumes.h"
#include "server/documents/ids.h"
#include "server/documents/node_grid_document.h"

namespace geosis::server {
namespace {

constexpr std::size_t kRecentGrids = 4;
constexpr const char* kGrid = "grid.json";
constexpr const char* kFile = "file";  ///< the member of a stored grid.json that names its file; shown to nobody
constexpr const char* kFilePrefix = "nodes-";

Error no_such_grid(const std::string& id) {
  return {ErrorCode::not_found, "grid " + id + ": there is no such grid"};
}

/// No other upload of any process has the same.
std::string new_file_name(const BlobStore& store) {
  static std::atomic<std::uint64_t> serial{0};
  return kFilePrefix + store.process_name() + "." + std::to_string(serial++);
}

Json public_grid(const Json& stored) {
  Json document;
  for (const auto& [name, value] : stored.items()) {
    if (name != kFile) document[name] = value;
  }
  const std::string volume = "/v1/volumes/" + stored.at("volume").get<std::string>();
  document["links"] = {{"self", volume + "/grids/" + stored.at("id").get<std::string>()}, {"volume", volume}};
  return document;
}

}  // namespace

Grids::Grids(BlobStore& store, std::string tenant, int threads)
    : store_(store), tenant_(std::move(tenant)), threads_(threads) {}

// ---- adding

Result<AddedGrid> Grids::add(const VolumeSummary& volume, const ByteSource& positions, const PositionFormat& format,
                             const std::function<Result<void>()>& confirm, Progress& progress) {
  auto staged = store_.stage();
  if (!staged) return std::move(staged).error();
  const auto grid = import_positions(positions, volume.shape, format, (*staged)->path(), threads_, progress);
  if (!grid) return grid.error();
  if (auto confirmed = confirm(); !confirmed) return std::move(confirmed).error();
  return keep(volume, grid->summary, name_of(format.kind), *std::move(staged));
}

Result<AddedGrid> Grids::place(const VolumeSummary& volume, const std::array<const BrickedVolume*, 3>& coordinates,
                               Progress& progress) {
  auto staged = store_.stage();
  if (!staged) return std::move(staged).error();
  const CoordinateVolumes given = {
      .volumes = coordinates, .otherwise = volume.geometry, .times = volume.sample_unit == "ms"};
  const auto grid = place_nodes(given, volume.shape, (*staged)->path(), threads_, progress);
  if (!grid) return grid.error();
  return keep(volume, grid->summary, "volumes", *std::move(staged));
}

/// What is here already stays, unless it is damaged.
Result<AddedGrid> Grids::keep(const VolumeSummary& volume, const NodeSummary& grid, const std::string& kind,
                              std::unique_ptr<StagedFile> file) {
  const auto known = open(volume, grid.digest);
  const bool is_damaged = !known && known.error().code == ErrorCode::internal;
  if (!known && !is_damaged && known.error().code != ErrorCode::not_found) return known.error();
  if (is_damaged) {
    if (auto done = remove_files(volume.id, grid.digest); !done) return std::move(done).error();
  }
  Result<bool> is_new = false;
  if (!known) is_new = store(volume, grid, kind, std::move(file));
  if (!is_new) return std::move(is_new).error();
  auto stored = document(volume.id, grid.digest);
  if (!stored) return std::move(stored).error();
  return AddedGrid{*is_new, *std::move(stored)};
}

/// True when grid.json is this upload's now; false when there is another one.
Result<bool> Grids::store(const VolumeSummary& volume, const NodeSummary& grid, const std::string& kind,
                          std::unique_ptr<StagedFile> file) {
  const std::string name = new_file_name(store_);
  const BlobKey folder = this->folder(volume.id, grid.digest);
  Json document = node_grid_document(grid, volume.id, kind);
  document["created_at"] = timestamp();
  document[kFile] = name;
  if (auto done = store_.commit(std::move(file), folder + name); !done) return std::move(done).error();
  auto is_new = store_.put_if(folder + kGrid, bytes_of(document_text(document)), "");
  if (is_new && *is_new) return true;
  // Not after an error that may have left grid.json visible: then the file counts.
  const auto now = read(volume.id, grid.digest);
  const bool counts = now ? now->value(kFile, "") == name : now.error().code != ErrorCode::not_found;
  if (!counts) static_cast<void>(store_.remove(folder + name));  // else garbage
  return is_new;
}

// ---- reading

Result<Json> Grids::read(const std::string& volume, const std::string& id) const {
  if (!is_id(volume) || !is_id(id)) return no_such_grid(id);
  const auto bytes = store_.get(folder(volume, id) + kGrid);
  if (!bytes) return bytes.error().code == ErrorCode::not_found ? no_such_grid(id) : bytes.error();
  return parse_json({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
}

std::shared_ptr<const NodeGrid> Grids::recent(const BlobKey& file) {
  const std::lock_guard lock(mutex_);
  const auto known = std::ranges::find(recent_, file, &Opened::file);
  if (known == recent_.end()) return nullptr;
  const auto path = store_.local_file(file);
  if (!path || identity_of(*path) != known->identity) {
    recent_.erase(known);
    return nullptr;
  }
  recent_.splice(recent_.begin(), recent_, known);
  return known->grid;
}

void Grids::remember(Opened opened) {
  const std::lock_guard lock(mutex_);
  recent_.push_front(std::move(opened));
  if (recent_.size() > kRecentGrids) recent_.pop_back();
}

Result<std::shared_ptr<const NodeGrid>> Grids::open(const VolumeSummary& volume, const std::string& id) {
  const auto document = read(volume.id, id);
  if (!document) return document.error();
  const BlobKey file = folder(volume.id, id) + document->value(kFile, "");
  if (auto known = recent(file)) return known;
  const auto path = store_.local_file(file);
  if (!path && path.error().code != ErrorCode::not_found) return path.error();
  if (!path) {  // what is removed loses its grid.json first, and what is replaced gets another one
    const auto now = read(volume.id, id);
    if (!now) return now.error();
    if (*now != *document) return open(volume, id);
  }
  const FileIdentity identity = path ? identity_of(*path) : FileIdentity{};
  auto opened = path ? open_node_file(volume.shape, *path) : Result<NodeGrid>(path.error());
  if (opened && opened->summary.digest == id) {
    const auto grid = std::make_shared<const NodeGrid>(*std::move(opened));
    remember({file, identity, grid});
    return grid;
  }
  store_.report_damage(file, opened ? "it is another grid" : opened.error().message);
  return Error{ErrorCode::internal, "grid " + id + ": what is stored of it is damaged; upload it again"};
}

Result<Json> Grids::document(const std::string& volume, const std::string& id) const {
  const auto stored = read(volume, id);
  if (!stored) return stored;
  return public_grid(*stored);
}

Result<Json> Grids::list(const std::string& volume, std::size_t page_size, const std::string& page_token) const {
  const auto ids = store_.children(folder(volume));
  if (!ids) return ids.error();
  Json page = {{"grids", Json::array()}, {"next_page_token", nullptr}};
  for (const std::string& id : *ids) {
    if (id <= page_token) continue;
    if (page["grids"].size() == page_size) {
      page["next_page_token"] = page["grids"].back()["id"];
      break;
    }
    auto grid = document(volume, id);
    if (grid)
      page["grids"].push_back(*std::move(grid));
    else if (grid.error().code != ErrorCode::not_found && grid.error().code != ErrorCode::internal)
      return grid;
  }
  return page;
}

// ---- removing

Result<void> Grids::remove(const std::string& volume, const std::string& id) {
  const auto stored = read(volume, id);
  if (!stored && stored.error().code == ErrorCode::internal) return remove_files(volume, id);
  if (!stored) return stored.error();
  if (auto done = forget(folder(volume, id)); !done) return done;
  return store_.remove(folder(volume, id) + stored->value(kFile, ""));  // not that of an upload which goes on
}

/// The document goes first: what is left is then no grid any more.
Result<void> Grids::forget(const BlobKey& folder) {
  if (auto done = store_.remove(folder + kGrid); !done) return done;
  const std::lock_guard lock(mutex_);
  recent_.remove_if([&](const Opened& opened) { return opened.file.starts_with(folder); });
  return {};
}

Result<void> Grids::remove_files(const std::string& volume, const std::string& id) {
  const BlobKey folder = this->folder(volume, id);
  if (auto done = forget(folder); !done) return done;
  return remove_children(store_, folder);
}

Result<void> Grids::remove_all(const std::string& volume) {
  const auto ids = store_.children(folder(volume));
  if (!ids) return ids.error();
  for (const std::string& id : *ids) {
    if (auto done = remove_files(volume, id); !done) return done;
  }
  return {};
}

Result<void> Grids::collect_garbage_of(const std::string& volume) {
  const auto ids = store_.children(folder(volume));
  if (!ids) return ids.error();
  for (const std::string& id : *ids) {
    const auto files = store_.children(folder(volume, id));
    if (!files) return files.error();
    for (const std::string& file : *files) {
      if (!file.starts_with(kFilePrefix)) continue;
      const std::string process = process_of(file.substr(std::string(kFilePrefix).size()));
      if (store_.may_be_running(process)) continue;
      const auto stored = read(volume, id);
      if (!stored && stored.error().code != ErrorCode::not_found) continue;  // not known which one counts
      if (stored && stored->value(kFile, "") == file) continue;
      if (auto done = store_.remove(folder(volume, id) + file); !done) return done;
    }
  }
  return {};
}

}  // namespace geosis::server
