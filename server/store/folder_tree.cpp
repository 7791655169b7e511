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
  std::vector<Identity> flushed;
  for (fs::path at = folder;; at = at.parent_path()) {
    Identity identity;
    const auto is_there = flush_one(at, identity);
    if (!is_there) return is_there.error();
    if (!*is_there) return {};
    if (is_known(identity)) break;
    flushed.push_back(identity);
    if (at == root_) break;
  }
  remember(flushed);
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

void FolderTree::remember(const std::vector<Identity>& identities) {
  const std::lock_guard lock(mutex_);
  if (known_.size() + identities.size() > kMaxKnown) known_.clear();
  for (const auto& identity : identities)
    if (identity != Identity{}) known_.insert(identity);
}

}  // namespace geosis::server
