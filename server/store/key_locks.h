#pragma once

#include <filesystem>
#include <string_view>
#include <utility>

#include "engine/base/result.h"
#include "server/store/file_calls.h"
#include "server/store/open_file.h"

namespace geosis::server {

/// Turns at changing a key, among the threads of all processes on a store: flock on one of a few files, so that the
/// lock of a process that dies is free at once.
class KeyLocks {
 public:
  /// folder   is there; holds the locked files, which stay.
  KeyLocks(FileCalls& calls, std::filesystem::path folder) : calls_(calls), folder_(std::move(folder)) {}

  /// Waits for the turn, which lasts as long as the file is open. Keys may share one: take no second turn meanwhile.
  ///
  /// errors   no_space, unavailable.
  Result<OpenFile> take(std::string_view key);

 private:
  FileCalls& calls_;
  std::filesystem::path folder_;
};

}  // namespace geosis::server
