#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace geosis {

/// A file of the shared survey data; it need not exist. GEOSIS_SHARED names the folder, default ../shared beside the
/// project.
inline std::filesystem::path shared_file(const std::string& name) {
  const char* folder = std::getenv("GEOSIS_SHARED");
  const std::filesystem::path beside = std::filesystem::path(GEOSIS_SOURCE_DIR) / "../shared";
  return (folder != nullptr ? std::filesystem::path(folder) : beside) / "data" / name;
}

}  // namespace geosis
