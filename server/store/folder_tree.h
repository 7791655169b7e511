#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "engine/base/result.h"
#include "server/store/file_calls.h"

namespace geosis::server {

/// Makes, flushes and removes the folders below one root, while other threads and processes do the same.
class FolderTree {
 public:
  /// root   is there, and its own entry is durable.
  FolderTree(FileCalls& calls, std::filesystem::path root) : calls_(calls), root_(std::move(root)) {}

  /// Makes a folder below the root, and those that lead to it, without flushing. Another process may remove it again
  /// while it is empty.
  ///
  /// errors   invalid_argument: a file is in the way.  no_space, unavailable.
  Result<void> make(const std::filesystem::path& folder);

  /// Makes the entries of a folder durable, and those of the folders that lead to it. A folder that is gone is no
  /// error: somebody removed what was in it.
  ///
  /// cost     one fsync; one more for each folder on the way up to the first that was flushed before.
  Result<void> flush(const std::filesystem::path& folder);

  /// Removes a folder and those that lead to it as far as they are empty.
  /// returns  the nearest folder that stays.
  std::filesystem::path remove_empty(std::filesystem::path folder);

 private:
  // Inode and time of birth: a folder that was removed and made again is another one. While a folder stays, so do those
  // that lead to it; so when their entries were flushed once, the way to it stays durable.
  using Identity = std::tuple<std::uint64_t, std::int64_t, std::uint32_t>;

  Result<bool> flush_one(const std::filesystem::path& folder, Identity& identity);
  bool is_known(const Identity& identity);
  void remember(const std::vector<Identity>& identities);

  FileCalls& calls_;
  std::filesystem::path root_;
  std::mutex mutex_;
  std::set<Identity> known_;
};

}  // namespace geosis::server
