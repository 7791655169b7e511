#include "server/app/volumes/volumes.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>
#include <utility>

#include "engine/volume/brick_file.h"
#include "server/app/volumes/volume_blobs.h"

namespace geosis::server {
namespace {

constexpr std::size_t kRecentVolumes = 16;
/// Bricks are checked at first touch after opening; a volume that is used for longer is opened anew.
constexpr std::chrono::minutes kLongestOpen{10};

}  // namespace

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
    if (!document.contains(name) && name != kUpload) document[name] = value;
  }
  document["links"] = {{"self", self},
                       {"histogram", self + "/histogram"},
                       {"grids", self + "/grids"},
                       {"extractions", self + "/extractions"}};
  return document;
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
    : store_(store), tenant_(std::move(tenant)), threads_(threads), grids_(store, tenant_, threads) {}

/// The right to have a folder of data without a volume.json that names it, as long as it lives.
class Volumes::Upload {
 public:
  explicit Upload(Volumes& volumes) : volumes_(volumes) {
    static std::atomic<std::uint64_t> serial{0};
    token_ = volumes.store_.process_name() + "." + std::to_string(serial++);
    const std::lock_guard lock(volumes_.mutex_);
    volumes_.uploads_.insert(token_);
  }
  Upload(const Upload&) = delete;
  Upload& operator=(const Upload&) = delete;
  ~Upload() {
    const std::lock_guard lock(volumes_.mutex_);
    volumes_.uploads_.erase(token_);
  }
  const std::string& token() const { return token_; }

 private:
  Volumes& volumes_;
  std::string token_;
};

Result<Json> Volumes::read_document(const std::string& id, const std::string& name) const {
  if (!is_id(id)) return no_such_volume(id);
  auto bytes = store_.get(key(id, name));
  if (!bytes) return bytes.error().code == ErrorCode::not_found ? no_such_volume(id) : bytes.error();
  return parse_json({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
}

Result<Json> Volumes::read_sidecar(const std::string& id, const Json& volume) const {
  auto sidecar = read_document(id, data_folder(volume) + kSidecar);
  if (!sidecar && sidecar.error().code == ErrorCode::not_found) return Json::object();  // removed just now
  return sidecar;
}

// ---- adding

Result<UploadResult> Volumes::add(const ByteSource& file, const UploadOptions& options, Progress& progress,
                                  std::vector<GridCandidate>& candidates) {
  auto bricks = store_.stage();
  if (!bricks) return std::move(bricks).error();
  auto imported = import_volume(file, options.import, (*bricks)->path(), progress, &candidates);
  if (!imported) return std::move(imported).error();
  imported->samples.reset();  // unmapped before it moves
  const VolumeDescription& description = imported->description;
  if (options.confirm) {
    if (auto confirmed = options.confirm(); !confirmed) return std::move(confirmed).error();
  }
  return keep(*std::move(bricks), description, options.name);
}

Result<UploadResult> Volumes::keep(std::unique_ptr<StagedFile> bricks, const VolumeDescription& description,
                                   const std::string& name) {
  const std::string id = volume_id(description);
  const auto known = open(id);
  if (!known && known.error().code != ErrorCode::not_found && known.error().code != ErrorCode::internal) {
    return known.error();
  }
  bool is_damaged = !known && known.error().code == ErrorCode::internal;
  {
    const std::lock_guard lock(mutex_);
    is_damaged = is_damaged || damaged_.erase(id) > 0;
  }
  if (is_damaged) {
    if (auto done = remove(id); !done && done.error().code != ErrorCode::not_found) return std::move(done).error();
  }
  Result<bool> is_new = false;
  if (!known || is_damaged) is_new = store(id, std::move(bricks), description, name);
  if (!is_new) return std::move(is_new).error();
  auto stored = document(id);
  if (!stored) return std::move(stored).error();
  return UploadResult{*is_new, *std::move(stored)};
}

Result<bool> Volumes::store(const std::string& id, std::unique_ptr<StagedFile> bricks,
                            const VolumeDescription& description, const std::string& name) {
  const Upload upload(*this);
  const std::string folder = upload_folder(upload.token());
  const Json sidecar = {{"name", name}, {"crs", nullptr}, {"created_at", timestamp()}};
  Json document = volume_document(description, name);
  document[kUpload] = upload.token();
  Result<bool> is_new = false;
  if (auto done = store_.commit(std::move(bricks), key(id, folder + kBricks)); !done) {
    is_new = std::move(done).error();
  } else if (done = store_.put(key(id, folder + kSidecar), bytes_of(document_text(sidecar))); !done) {
    is_new = std::move(done).error();
  } else {
    is_new = store_.put_if(key(id, kVolume), bytes_of(document_text(document)), "");
  }
  if (is_new && *is_new) return true;
  // Not after an error that may have left volume.json visible: then the folder counts.
  const auto now = read_document(id, kVolume);
  const bool counts = now ? now->value(kUpload, "") == upload.token() : now.error().code != ErrorCode::not_found;
  if (!counts) static_cast<void>(remove_upload(id, upload.token()));  // else garbage
  return is_new;
}

// ---- reading

std::shared_ptr<const StoredVolume> Volumes::recent(const std::string& id) {
  const std::lock_guard lock(mutex_);
  const auto known =
      std::find_if(recent_.begin(), recent_.end(), [&](const Opened& o) { return o.volume->summary.id == id; });
  if (known == recent_.end()) return nullptr;
  if (std::chrono::steady_clock::now() - known->at > kLongestOpen || identity_of(known->path) != known->identity) {
    recent_.erase(known);
    return nullptr;
  }
  recent_.splice(recent_.begin(), recent_, known);
  return known->volume;
}

Result<std::shared_ptr<const StoredVolume>> Volumes::open(const std::string& id) {
  if (auto known = recent(id)) return known;
  const auto document = read_document(id, kVolume);
  if (!document) return document.error();
  auto summary = parse_volume_document(*document);
  if (!summary) return judged(id, summary.error());
  const auto path = store_.local_file(key(id, data_folder(*document) + kBricks));
  if (!path) {
    if (path.error().code != ErrorCode::not_found) return path.error();
    // What is removed loses its volume.json first, and what is replaced gets another one.
    const auto now = read_document(id, kVolume);
    if (!now) return now.error();
    if (*now != *document) return open(id);
    return judged(id, {ErrorCode::malformed_input, "its bricks are gone"});
  }
  const FileIdentity identity = identity_of(*path);
  auto samples = open_brick_file(*path);
  if (!samples) return judged(id, samples.error());
  std::shared_ptr<const StoredVolume> volume =
      std::make_shared<StoredVolume>(StoredVolume{*std::move(summary), *std::move(samples)});
  const std::lock_guard lock(mutex_);
  recent_.push_front({volume, *path, identity, std::chrono::steady_clock::now()});
  if (recent_.size() > kRecentVolumes) recent_.pop_back();
  return volume;
}

void Volumes::forget(const std::string& id) {
  const std::lock_guard lock(mutex_);
  recent_.remove_if([&](const Opened& opened) { return opened.volume->summary.id == id; });
}

Error Volumes::judged(const std::string& id, Error error) {
  if (error.code != ErrorCode::malformed_input) return error;
  store_.report_damage(key(id, kBricks), error.message);
  forget(id);
  const std::lock_guard lock(mutex_);
  damaged_.insert(id);
  return {ErrorCode::internal, "volume " + id + ": what is stored of it is damaged; upload it again"};
}

Result<Json> Volumes::document(const std::string& id) const {
  const auto volume = read_document(id, kVolume);
  if (!volume) return volume;
  const auto sidecar = read_sidecar(id, *volume);
  if (!sidecar) return sidecar;
  return public_document(*volume, *sidecar);
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
    else if (volume.error().code != ErrorCode::not_found && volume.error().code != ErrorCode::internal)
      return volume;
  }
  return page;
}

// ---- samples

Result<Histogram> Volumes::histogram(const std::string& id, int bins, Progress& progress) {
  const auto volume = open(id);
  if (!volume) return volume.error();
  auto counted = count_values(*(*volume)->samples, bins, threads_, progress);
  if (!counted) return judged(id, counted.error());
  return counted;
}

Result<Slice> Volumes::slice(const std::string& id, SliceAxis axis, std::int32_t index) {
  const auto volume = open(id);
  if (!volume) return volume.error();
  auto read = read_slice(*(*volume)->samples, axis, index);
  if (read) return read;
  Error error = read.error();
  if (error.code == ErrorCode::invalid_argument) error.message += which_node(id, axis, index);
  return judged(id, std::move(error));
}

/// "; inline 1971 is node 20" where the number asked for is one of the survey's own, else nothing.
std::string Volumes::which_node(const std::string& id, SliceAxis axis, std::int32_t number) const {
  const auto volume = document(id);
  if (!volume) return "";
  const auto node = node_called(*volume, static_cast<int>(axis), number);
  if (!node) return "";
  const std::string text = std::to_string(number);
  const std::string unit = volume->at("axes").at("sample").at("unit").get<std::string>();
  const std::string what = axis == SliceAxis::inline_     ? "inline " + text
                           : axis == SliceAxis::crossline ? "crossline " + text
                                                          : text + (unit.empty() ? "" : " " + unit);
  return "; " + what + " is node " + std::to_string(*node);
}

}  // namespace geosis::server
