#include "server/app/volumes.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <utility>

#include "engine/volume/brick_file.h"
#include "server/documents/ids.h"

namespace geosis::server {
namespace {

constexpr const char* kBricks = "bricks";
constexpr const char* kSidecar = "sidecar.json";
constexpr const char* kVolume = "volume.json";  // there = the volume is there
constexpr std::size_t kRecentVolumes = 16;

Error no_such_volume(const std::string& id) {
  return {ErrorCode::not_found, "volume " + id + ": there is no such volume"};
}

/// The stored documents put together, in the contract's order.
Json public_document(const Json& volume, const Json& sidecar) {
  const std::string id = volume.at("id").get<std::string>();
  const std::string self = "/v1/volumes/" + id;
  Json document = {{"id", id},
                   {"state", "ready"},
                   {"progress", 1},
                   {"name", sidecar.value("name", Json(nullptr))},
                   {"created_at", sidecar.value("created_at", Json(nullptr))},
                   {"crs", sidecar.value("crs", Json(nullptr))}};
  for (const auto& [name, value] : volume.items()) {
    if (!document.contains(name)) document[name] = value;
  }
  document["links"] = {{"self", self}, {"histogram", self + "/histogram"}, {"extractions", self + "/extractions"}};
  return document;
}

}  // namespace

bool is_id(const std::string& text) {
  return text.size() == 64 &&
         std::all_of(text.begin(), text.end(), [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

std::string timestamp() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

Volumes::Volumes(BlobStore& store, std::string tenant, int threads)
    : store_(store), tenant_(std::move(tenant)), threads_(threads) {}

Result<Json> Volumes::read_document(const std::string& id, const char* name) const {
  if (!is_id(id)) return no_such_volume(id);
  auto bytes = store_.get(key(id, name));
  if (!bytes) return bytes.error().code == ErrorCode::not_found ? no_such_volume(id) : bytes.error();
  return parse_json({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
}

Result<void> Volumes::write_document(const std::string& id, const char* name, const Json& document) {
  const std::string text = document_text(document);
  return store_.put(key(id, name), std::as_bytes(std::span(text)));
}

Result<UploadResult> Volumes::add(const ByteSource& file, const UploadOptions& options, Progress& progress,
                                  std::vector<GridCandidate>& candidates) {
  auto bricks = store_.stage();
  if (!bricks) return std::move(bricks).error();
  auto imported = import_volume(file, options.import, (*bricks)->path(), progress, &candidates);
  if (!imported) return std::move(imported).error();
  const VolumeDescription& description = imported->description;
  if (options.digest && *options.digest != description.digest) {
    return Error{ErrorCode::invalid_argument,
                 "SHA-256 of the body is " + description.digest + "; the request states " + *options.digest};
  }
  const std::string id = volume_id(description);
  const std::lock_guard lock(writing_);
  if (auto here = document(id); here && store_.local_file(key(id, kBricks))) {
    return UploadResult{false, *std::move(here)};
  }

  imported->samples.reset();  // unmapped before it moves
  if (auto done = store_.commit(*std::move(bricks), key(id, kBricks)); !done) return std::move(done).error();
  const Json sidecar = {{"name", options.name}, {"crs", nullptr}, {"created_at", timestamp()}};
  if (auto done = write_document(id, kSidecar, sidecar); !done) return std::move(done).error();
  if (auto done = write_document(id, kVolume, volume_document(description, options.name)); !done) {
    return std::move(done).error();
  }
  auto stored = document(id);
  if (!stored) return std::move(stored).error();
  return UploadResult{true, *std::move(stored)};
}

Result<std::shared_ptr<const StoredVolume>> Volumes::open(const std::string& id) {
  const std::lock_guard lock(mutex_);
  const auto known = std::find_if(recent_.begin(), recent_.end(), [&](const auto& v) { return v->summary.id == id; });
  if (known != recent_.end()) {
    recent_.splice(recent_.begin(), recent_, known);
    return recent_.front();
  }
  const auto document = read_document(id, kVolume);
  if (!document) return document.error();
  auto summary = parse_volume_document(*document);
  if (!summary) return std::move(summary).error();
  const auto path = store_.local_file(key(id, kBricks));
  if (!path) return path.error();
  auto samples = open_brick_file(*path);
  if (!samples) return std::move(samples).error();
  recent_.push_front(std::make_shared<StoredVolume>(StoredVolume{*std::move(summary), *std::move(samples)}));
  if (recent_.size() > kRecentVolumes) recent_.pop_back();
  return recent_.front();
}

Result<Json> Volumes::document(const std::string& id) const {
  const auto volume = read_document(id, kVolume);
  if (!volume) return volume;
  const auto sidecar = read_document(id, kSidecar);
  return public_document(*volume, sidecar ? *sidecar : Json::object());
}

Result<Json> Volumes::list(std::size_t page_size, const std::string& page_token) const {
  auto ids = store_.children(tenant_ + "/volumes/");
  if (!ids) return std::move(ids).error();
  Json page = {{"volumes", Json::array()}, {"next_page_token", nullptr}};
  for (const std::string& id : *ids) {
    if (id <= page_token) continue;
    if (page["volumes"].size() == page_size) {
      page["next_page_token"] = page["volumes"].back()["id"];
      break;
    }
    auto volume = document(id);
    if (volume)
      page["volumes"].push_back(*std::move(volume));
    else if (volume.error().code != ErrorCode::not_found)
      return volume;
  }
  return page;
}

Result<Json> Volumes::change(const std::string& id, const Json& changes) {
  const std::lock_guard lock(writing_);
  if (auto volume = read_document(id, kVolume); !volume) return volume;
  if (!changes.is_object()) return Error{ErrorCode::invalid_argument, "/: expected an object"};
  for (const auto& [name, value] : changes.items()) {
    if (name != "name" && name != "crs") return Error{ErrorCode::invalid_argument, "/" + name + ": cannot be changed"};
    if (!value.is_string() && !value.is_null()) {
      return Error{ErrorCode::invalid_argument, "/" + name + ": " + value.dump() + "; expected a string or null"};
    }
  }
  auto sidecar = read_document(id, kSidecar);
  Json merged = sidecar ? *std::move(sidecar) : Json::object();
  for (const auto& [name, value] : changes.items()) merged[name] = value;
  if (auto done = write_document(id, kSidecar, merged); !done) return std::move(done).error();
  return document(id);
}

Result<void> Volumes::remove(const std::string& id) {
  const std::lock_guard lock(writing_);
  if (auto volume = read_document(id, kVolume); !volume) return volume.error();
  for (const char* name : {kVolume, kSidecar, kBricks}) {
    if (auto done = store_.remove(key(id, name)); !done) return done;
  }
  const std::lock_guard recent(mutex_);  // after it is gone: nobody opens it again
  recent_.remove_if([&](const auto& v) { return v->summary.id == id; });
  return {};
}

Result<Histogram> Volumes::histogram(const std::string& id, int bins, Progress& progress) {
  const auto volume = open(id);
  if (!volume) return volume.error();
  return count_values(*(*volume)->samples, bins, threads_, progress);
}

Result<Slice> Volumes::slice(const std::string& id, SliceAxis axis, std::int32_t index) {
  const auto volume = open(id);
  if (!volume) return volume.error();
  return read_slice(*(*volume)->samples, axis, index);
}

}  // namespace geosis::server
