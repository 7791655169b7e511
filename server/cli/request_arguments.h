#pragma once

#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "engine/base/result.h"
#include "server/documents/json_text.h"

namespace geosis::server {

/// The flags that make a request, and the file that may hold one.
class RequestArguments {
 public:
  explicit RequestArguments(CLI::App& command);

  /// The request file's document with the flags written over it. It is checked where every request is: parse_request.
  ///
  /// errors   not_found, unavailable, malformed_input: the file.  invalid_argument: a flag that cannot be read.
  Result<Json> document() const;
  /// File of the volume that the attribute `value` is of; empty when there is none.
  const std::string& attribute_volume() const { return attribute_volume_; }

 private:
  Result<void> write_shape(Json& document) const;
  Result<void> write_missing(Json& document) const;
  Result<void> write_bodies(Json& document) const;
  Result<void> write_attributes(Json& document) const;

  std::pair<std::string, std::string> range_;
  std::string request_path_;
  std::string grid_, mode_, region_, space_, velocity_;
  bool no_cap_ = false, preview_ = false;
  std::string missing_, kernel_, steer_, max_distance_;
  std::string min_voxels_, largest_;
  std::vector<std::string> seeds_;
  std::string attributes_, attribute_volume_;
};

}  // namespace geosis::server
