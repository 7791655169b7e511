#include "server/store/folder_tree.h"

#include <cerrno>
#include <utility>

#include <fcntl.h>

#include "server/store/open_file.h"

namespace geosis::server {
namespace {

namespace fs = std::filesystem;

constexpr mode_t kFolderMode = 0777;        // less the umask
constexpr std::size_t kMaxKnown = 1 << 14;  // about 1 MB

}  // namespace

Result<void> FolderTree::make(const fs::path& folder) {
  if (calls_.mkdir(folder.c_str(), kFolderMode) == 0 || errno == EEXIST) return {};
  if (errno == ENOENT && folder != root_) {
    if (auto made = make(folder.parent_path()); !made) return made;
    // ENOENT once more: the parent was empty and another process has removed it. The caller sees that and tries again.
    if (calls_.mkdir(folder.c_str(), kFolderMode) == 0 || errno == EEXIST || errno == ENOENT) return {};
  }
  if (errno == ENOTDIR) return Error{ErrorCode::invalid_argument, folder.string() + ": leads through a file"};
  return file_error(folder, "cannot make this folder", errno);
}

Result<void> FolderTree::flush(const fs::path& folder) {
  Identity identity;
  const auto flushed = flush_one(folder, identity);
  if (!flushed) return flushed.error();
  if (!*flushed || is_known(identity)) return {};
  for (fs::path above = folder; above != root_;) {
    above = above.parent_path();
    Identity ignored;
    const auto flushed_above = flush_one(above, ignored);
    if (!flushed_above) return flushed_above.error();
    if (!*flushed_above) return {};
  }
  remember(identity);
  return {};
}

fs::path FolderTree::remove_empty(fs::path folder) {
  while (folder != root_ && (calls_.rmdir(folder.c_str()) == 0 || errno == ENOENT || errno == ENOTDIR))
    folder = folder.parent_path();
  return folder;
}

// False when the folder is gone. The identity has no inode where the file system does not tell the time of birth.
Result<bool> FolderTree::flush_one(const fs::path& folder, Identity& identity) {
  OpenFile file(calls_, calls_.open(folder.c_str(), O_RDONLY | O_DIRECTORY, 0));
  if (!file.is_open()) {
    if (errno == ENOENT) return false;
    return file_error(folder, "cannot open this folder", errno);
  }
  if (calls_.fsync(file.descriptor()) != 0) return file_error(folder, "cannot flush this folder", errno);
  struct statx status {};
  const bool told = calls_.statx(file.descriptor(), STATX_INO | STATX_BTIME, &status) == 0;
  if (told && (status.stx_mask & STATX_BTIME) != 0)
    identity = {status.stx_ino, status.stx_btime.tv_sec, status.stx_btime.tv_nsec};
  return true;
}

bool FolderTree::is_known(const Identity& identity) {
  const std::lock_guard lock(mutex_);
  return known_.contains(identity);
}

void FolderTree::remember(const Identity& identity) {
  if (identity == Identity{}) return;
  const std::lock_guard lock(mutex_);
  if (known_.size() == kMaxKnown) known_.clear();
  known_.insert(identity);
}

}  // namespace geosis::server
