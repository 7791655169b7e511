#include "engine/volume/new_file.h"

#include <atomic>
#include <string>
#include <system_error>
#include <utility>

#include <unistd.h>

namespace geosis {
namespace {

std::filesystem::path unfinished_name(const std::filesystem::path& path) {
  static std::atomic<unsigned> serial = 0;
  std::filesystem::path name = path;
  name += ".";
  name += std::to_string(::getpid());
  name += "-";
  name += std::to_string(serial++);
  name += ".part";
  return name;
}

}  // namespace

Result<NewFile> NewFile::create(const std::optional<std::filesystem::path>& path, std::uint64_t bytes) {
  const std::filesystem::path unfinished = path ? unfinished_name(*path) : std::filesystem::path();
  auto mapped = path ? MappedFile::create(unfinished, bytes) : MappedFile::create_unnamed(bytes);
  if (!mapped) return std::move(mapped).error();
  NewFile file(*std::move(mapped));
  if (path) {
    file.path_ = *path;
    file.unfinished_ = unfinished;
  }
  return file;
}

NewFile::~NewFile() {
  if (!file_ || unfinished_.empty()) return;
  std::error_code ignored;
  std::filesystem::remove(unfinished_, ignored);
}

Result<std::unique_ptr<MappedFile>> NewFile::publish() && {
  if (unfinished_.empty()) return std::move(file_);
  if (auto synced = file_->sync(); !synced) return std::move(synced).error();
  std::error_code failed;
  std::filesystem::rename(unfinished_, path_, failed);
  if (failed)
    return Error{ErrorCode::unavailable, "cannot rename a file to " + path_.string() + ": " + failed.message()};
  unfinished_.clear();
  if (auto synced = sync_folder(path_.parent_path()); !synced) return std::move(synced).error();
  return std::move(file_);
}

}  // namespace geosis
