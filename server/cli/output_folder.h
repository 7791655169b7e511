#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "engine/base/result.h"

namespace geosis::server {

/// A folder that gets all files of a run or none: they are written in a hidden folder inside and moved by commit().
/// Without commit() nothing stays behind, not even the folder if it was not there before.
class OutputFolder {
 public:
  /// errors   unavailable: the folder cannot be made or written in.
  static Result<OutputFolder> open(const std::filesystem::path& folder);

  OutputFolder(OutputFolder&& other) noexcept;
  OutputFolder& operator=(OutputFolder&&) = delete;
  ~OutputFolder();

  /// Writes one file with what `fill` puts into the stream.
  ///
  /// errors   those of fill; unavailable: writing failed.
  Result<void> write(const std::string& name, const std::function<Result<void>(std::ostream&)>& fill);

  /// Moves the files to their place in the order of writing, after removing `stale`'s matches among the files of an
  /// earlier run. The last file is the one that tells readers that the others are there.
  Result<void> commit(const std::function<bool(const std::string& name)>& is_stale);

 private:
  OutputFolder(std::filesystem::path folder, std::filesystem::path hidden, bool made_folder);

  std::filesystem::path folder_;
  std::filesystem::path hidden_;
  bool made_folder_ = false;
  std::vector<std::string> names_;
};

}  // namespace geosis::server
