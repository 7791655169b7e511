#pragma once

#include <string>
#include <vector>

#include "engine/base/result.h"
#include "server/app/extractions/extraction.h"

namespace geosis::server {

/// Volumes that an extraction was computed from: when one of them goes, so does the result.
inline std::vector<std::string> volumes_of(const Extraction::Identity& identity) {
  std::vector<std::string> volumes{identity.volume};
  const Json other = identity.request.value("attribute_volume", Json(nullptr));
  if (other.is_string()) volumes.push_back(other.get<std::string>());
  return volumes;
}

inline Error no_such_extraction(const std::string& id) {
  return {ErrorCode::not_found, "extraction " + id + ": there is no such extraction"};
}

}  // namespace geosis::server
