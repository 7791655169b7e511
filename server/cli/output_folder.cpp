#include "server/cli/output_folder.h"

#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <utility>

namespace geosis::server {
namespace {

namespace fs = std::filesystem;

Error failure(const fs::path& path, const char* what, const std::error_code& reason) {
  return {ErrorCode::unavailable, path.string() + ": " + what + ": " + reason.message()};
}

std::error_code last_system_error() {
  return {errno, std::generic_category()};
}

}  // namespace

Result<OutputFolder> OutputFolder::open(const fs::path& folder) {
  std::error_code problem;
  const bool made_folder = fs::create_directories(folder, problem);
  if (problem) return failure(folder, "cannot make this folder", problem);
  std::string hidden = (folder / ".geosis-XXXXXX").string();
  if (!mkdtemp(hidden.data())) {
    const auto reason = last_system_error();
    if (made_folder) fs::remove(folder, problem);
    return failure(folder, "cannot write in this folder", reason);
  }
  return OutputFolder(folder, hidden, made_folder);
}

OutputFolder::OutputFolder(fs::path folder, fs::path hidden, bool made_folder)
    : folder_(std::move(folder)), hidden_(std::move(hidden)), made_folder_(made_folder) {}

OutputFolder::OutputFolder(OutputFolder&& other) noexcept
    : folder_(std::move(other.folder_)),
      hidden_(std::exchange(other.hidden_, {})),
      made_folder_(std::exchange(other.made_folder_, false)),
      names_(std::move(other.names_)) {}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  if (!hidden_.empty()) fs::remove_all(hidden_, ignored);
  if (made_folder_) fs::remove(folder_, ignored);  // only when it is empty
}

Result<void> OutputFolder::write(const std::string& name, const std::function<Result<void>(std::ostream&)>& fill) {
  std::ofstream stream(hidden_ / name, std::ios::binary);
  if (!stream) return failure(folder_ / name, "cannot write", last_system_error());
  if (auto filled = fill(stream); !filled) return filled;
  stream.close();
  if (!stream) return failure(folder_ / name, "cannot write", last_system_error());
  names_.push_back(name);
  return {};
}

Result<void> OutputFolder::commit(const std::function<bool(const std::string& name)>& is_stale) {
  std::error_code problem;
  std::vector<fs::path> stale;
  for (const auto& entry : fs::directory_iterator(folder_, problem)) {
    if (entry.is_regular_file(problem) && is_stale(entry.path().filename().string())) stale.push_back(entry.path());
  }
  for (const auto& path : stale) fs::remove(path, problem);
  for (const auto& name : names_) {
    fs::rename(hidden_ / name, folder_ / name, problem);
    if (problem) return failure(folder_ / name, "cannot write", problem);
  }
  return {};
}

}  // namespace geosis::server
