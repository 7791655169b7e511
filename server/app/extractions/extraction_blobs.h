#pragma once

#include <string>

namespace geosis::server {

// Names of what the store has of one extraction, below <tenant>/extractions/<id>/.
inline constexpr const char* kRequest = "request.json";
inline constexpr const char* kBodies = "bodies.json";
inline constexpr const char* kEmptyBecause = "empty.json";  ///< of a result without levels; before the manifest
inline constexpr const char* kManifest = "manifest.json";   ///< there = it is done
inline constexpr const char* kRun = "run.json";             ///< RunRecord
inline constexpr const char* kEarlyLevels = "levels.json";  ///< those ready so far, until it is done

inline std::string part_name(int level, int part) {
  return "parts/" + std::to_string(level) + "." + std::to_string(part) + ".drc";
}

}  // namespace geosis::server
