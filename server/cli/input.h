#pragma once

#include <map>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/volume/formats/import.h"

namespace geosis::server {

/// The INPUT argument and the import options as flags: --null-value, --inline-byte, ...
class InputArguments {
 public:
  explicit InputArguments(CLI::App& command);

  /// Imports the file into an unnamed temporary brick file.
  ///
  /// errors   those of open_file and import_volume; the candidates of a refused survey are listed in the message.
  Result<ImportedVolume> import(Progress& progress) const;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
  std::map<std::string, std::string> texts_;  // option name -> what was given; empty = not given
};

}  // namespace geosis::server
