#include "server/store/key_walk.h"

#include <algorithm>
#include <cerrno>

#include "server/store/blob_key.h"
#include "server/store/open_file.h"

namespace geosis::server {
namespace {

// A folder stands where the keys below it do: "a.json" < "a/b", although "a" < "a.json".
std::string sort_key(const FolderEntry& entry) {
  return entry.is_folder ? entry.name + "/" : entry.name;
}

}  // namespace

Result<std::vector<FolderEntry>> key_entries(FileCalls& calls, const std::filesystem::path& folder) {
  std::vector<FolderEntry> entries;
  if (calls.list_folder(folder.c_str(), entries) != 0) {
    if (errno == ENOENT || errno == ENOTDIR) return std::vector<FolderEntry>{};
    return file_error(folder, "cannot read this folder", errno);
  }
  std::erase_if(entries, [](const FolderEntry& entry) {
    return (!entry.is_file && !entry.is_folder) || !is_key_segment(entry.name);
  });
  std::sort(entries.begin(), entries.end(),
            [](const FolderEntry& a, const FolderEntry& b) { return sort_key(a) < sort_key(b); });
  return entries;
}

Result<void> KeyWalk::add(const std::string& prefix) {
  const auto entries = key_entries(calls_, objects_ / prefix);
  if (!entries) return entries.error();
  for (const auto& entry : *entries) {
    if (blobs_.size() >= limit_) break;
    const std::string key = prefix + sort_key(entry);
    if (entry.is_file && key > after_) blobs_.push_back({key, entry.bytes, entry.modified});
    const bool has_later_keys = key > after_ || after_.starts_with(key);
    if (!entry.is_folder || !has_later_keys) continue;
    if (auto added = add(key); !added) return added;
  }
  return {};
}

}  // namespace geosis::server
