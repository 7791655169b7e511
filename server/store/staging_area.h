#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "engine/base/result.h"
#include "server/store/blob_store.h"
#include "server/store/open_file.h"

namespace geosis::server {

/// Where this process makes files before they are moved to their place: a folder of its own below the store's staging
/// folder, locked (flock) as long as the process lives. Opening one removes the folders that nobody locks any more.
class StagingArea {
 public:
  /// folder   the staging folder that all processes share; it is there.
  /// errors   no_space, unavailable.
  static Result<std::unique_ptr<StagingArea>> open(FileCalls& calls, const std::filesystem::path& folder);
  StagingArea(const StagingArea&) = delete;
  StagingArea& operator=(const StagingArea&) = delete;
  /// Removes what was not moved away.
  ~StagingArea();

  /// A new, empty file. errors: no_space, unavailable.
  Result<std::unique_ptr<StagedFile>> stage();
  /// The name of this process's folder, and so of the process.
  std::string process_name() const { return folder_.filename().string(); }
  /// False when nobody locks the folder of that name, or there is none.
  bool may_be_running(const std::string& process) const;
  bool owns(const StagedFile& file) const { return file.path().parent_path() == folder_; }

 private:
  StagingArea(FileCalls& calls, std::filesystem::path folder, OpenFile lock);

  FileCalls& calls_;
  std::filesystem::path folder_;
  OpenFile lock_;
  std::atomic<std::uint64_t> serial_{0};
};

}  // namespace geosis::server
