#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/result.h"
#include "server/store/blob_store.h"
#include "server/store/file_calls.h"

namespace geosis::server {

/// Entries of a folder whose names can be in a key, sorted as the keys below them are; none when there is no such
/// folder.
///
/// errors   unavailable.
Result<std::vector<FolderEntry>> key_entries(FileCalls& calls, const std::filesystem::path& folder);

/// Collects blobs in ascending order from a folder of blobs, without looking at more folders than needed.
class KeyWalk {
 public:
  KeyWalk(FileCalls& calls, const std::filesystem::path& objects, std::string_view after, std::size_t limit)
      : calls_(calls), objects_(objects), after_(after), limit_(limit) {}

  /// Adds the blobs below `prefix` ("" or ends with "/"). errors: unavailable.
  Result<void> add(const std::string& prefix);
  std::vector<BlobInfo>& blobs() { return blobs_; }

 private:
  FileCalls& calls_;
  const std::filesystem::path& objects_;
  std::string_view after_;
  std::size_t limit_;
  std::vector<BlobInfo> blobs_;
};

}  // namespace geosis::server
