#include "server/app/limited_store.h"

#include <algorithm>
#include <system_error>
#include <utility>
#include <vector>

#include "server/app/extractions/extraction_blobs.h"

namespace geosis::server {
namespace {

constexpr std::chrono::seconds kBetweenTouches{5};
constexpr std::size_t kMostTouched = 4096;
/// Documents are let in even when the store is full: without them nothing could be cancelled or told.
constexpr std::size_t kSmallBytes = 1 << 16;

/// What is removed together.
struct Derived {
  std::vector<BlobKey> blobs;  ///< the manifest first
  std::uint64_t bytes = 0;
  std::chrono::system_clock::time_point used{};
  bool is_whole = false;  ///< done: nobody writes to it any more

  void add(const BlobInfo& blob) {
    blobs.push_back(blob.key);
    bytes += blob.bytes;
    used = std::max(used, blob.used);
  }
};

/// The segments of a key, at most five: "t/extractions/<id>/parts/0.0.drc".
std::vector<std::string> segments_of(const BlobKey& key) {
  std::vector<std::string> segments;
  std::size_t begin = 0;
  for (std::size_t end = key.find('/'); end != BlobKey::npos && segments.size() < 4; end = key.find('/', begin)) {
    segments.push_back(key.substr(begin, end - begin));
    begin = end + 1;
  }
  segments.push_back(key.substr(begin));
  return segments;
}

std::vector<Derived> derived_among(const std::vector<BlobInfo>& blobs) {
  std::map<std::string, Derived> groups;
  for (const BlobInfo& blob : blobs) {
    const auto segments = segments_of(blob.key);
    if (segments.size() >= 4 && segments[1] == "extractions") {
      if (segments[3] == kRequest || segments[3] == kRun) continue;
      Derived& group = groups[segments[0] + "/" + segments[2]];
      group.add(blob);
      if (segments[3] == kManifest) {
        group.is_whole = true;
        std::swap(group.blobs.front(), group.blobs.back());
      }
    } else if (segments.size() == 5 && segments[1] == "volumes" &&
               (segments[3] == "fills" || segments[3] == "structures")) {
      Derived& group = groups[blob.key];
      group.add(blob);
      group.is_whole = true;
    }
  }
  std::vector<Derived> whole;
  for (auto& [name, group] : groups) {
    if (group.is_whole) whole.push_back(std::move(group));
  }
  std::sort(whole.begin(), whole.end(), [](const Derived& a, const Derived& b) { return a.used < b.used; });
  return whole;
}

}  // namespace

LimitedStore::LimitedStore(std::unique_ptr<BlobStore> store, Options options)
    : store_(std::move(store)), options_(options) {
  store_->on_damage([this](const BlobKey& key, const std::string& why) { report_damage(key, why); });
}

Result<void> LimitedStore::put(const BlobKey& key, std::span<const std::byte> bytes) {
  if (bytes.size() > kSmallBytes) {
    if (auto room = make_room(bytes.size()); !room) return room;
  }
  return store_->put(key, bytes);
}

Result<void> LimitedStore::commit(std::unique_ptr<StagedFile> file, const BlobKey& key) {
  std::error_code gone;
  const auto bytes = file ? std::filesystem::file_size(file->path(), gone) : 0;
  if (!gone) {
    if (auto room = make_room(bytes); !room) return room;
  }
  return store_->commit(std::move(file), key);
}

void LimitedStore::touch(const BlobKey& key) {
  if (options_.limit == 0) return;
  {
    const std::lock_guard lock(touching_);
    const auto now = std::chrono::steady_clock::now();
    if (touched_.size() >= kMostTouched) touched_.clear();
    auto& last = touched_[key];
    if (last != std::chrono::steady_clock::time_point{} &&
        now - last < std::min<std::chrono::nanoseconds>(kBetweenTouches, options_.grace / 4))
      return;
    last = now;
  }
  store_->touch(key);
}

Result<void> LimitedStore::make_room(std::uint64_t bytes) {
  if (options_.limit == 0) return {};
  if (bytes > options_.limit) {
    return Error{ErrorCode::no_space,
                 std::to_string(bytes) + " bytes do not fit into a store of " + std::to_string(options_.limit)};
  }
  const std::lock_guard lock(mutex_);
  const auto now = std::chrono::steady_clock::now();
  if (now - seen_ > options_.freshness || stored_ + bytes > options_.limit) {
    if (auto evicted = evict_down_to(options_.limit - bytes); !evicted) return evicted;
    seen_ = now;
  }
  if (stored_ + bytes > options_.limit) {
    return Error{ErrorCode::no_space, "the store holds " + std::to_string(stored_) + " of " +
                                          std::to_string(options_.limit) + " bytes, and nothing that could be removed"};
  }
  stored_ += bytes;
  return {};
}

/// Counts what is stored and removes what was used longest ago as far as needed.
Result<void> LimitedStore::evict_down_to(std::uint64_t most) {
  const auto blobs = store_->inventory("");
  if (!blobs) return blobs.error();
  stored_ = 0;
  for (const BlobInfo& blob : *blobs) stored_ += blob.bytes;
  if (stored_ <= most) return {};
  const auto latest = std::chrono::system_clock::now() - options_.grace;
  for (const Derived& group : derived_among(*blobs)) {
    if (stored_ <= most || group.used > latest) break;
    for (const BlobKey& blob : group.blobs) {
      if (auto done = store_->remove(blob); !done) return done;
    }
    stored_ -= group.bytes;
  }
  return {};
}

}  // namespace geosis::server
