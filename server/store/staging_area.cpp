#include "server/store/staging_area.h"

#include <cerrno>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>

#include "server/store/blob_key.h"

namespace geosis::server {
namespace {

namespace fs = std::filesystem;

constexpr mode_t kFileMode = 0666;  // less the umask

class DirStagedFile final : public StagedFile {
 public:
  DirStagedFile(FileCalls& calls, fs::path path) : calls_(calls), path_(std::move(path)) {}
  DirStagedFile(const DirStagedFile&) = delete;
  DirStagedFile& operator=(const DirStagedFile&) = delete;
  ~DirStagedFile() override { calls_.unlink(path_.c_str()); }  // does nothing once it was moved: names never return

  const fs::path& path() const override { return path_; }

 private:
  FileCalls& calls_;
  fs::path path_;
};

OpenFile open_folder(FileCalls& calls, const fs::path& folder) {
  return {calls, calls.open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW, 0)};
}

// What cannot be removed stays: it costs space only, and the next start tries again.
void remove_flat_folder(FileCalls& calls, const fs::path& folder) {
  std::vector<FolderEntry> entries;
  calls.list_folder(folder.c_str(), entries);
  for (const auto& entry : entries) calls.unlink((folder / entry.name).c_str());
  calls.rmdir(folder.c_str());
}

void remove_stale_folders(FileCalls& calls, const fs::path& staging) {
  std::vector<FolderEntry> entries;
  calls.list_folder(staging.c_str(), entries);
  for (const auto& entry : entries) {
    if (!entry.is_folder) continue;
    const OpenFile folder = open_folder(calls, staging / entry.name);
    const bool is_stale = folder.is_open() && calls.flock(folder.descriptor(), LOCK_EX | LOCK_NB) == 0;
    if (is_stale) remove_flat_folder(calls, staging / entry.name);
  }
}

}  // namespace

Result<std::unique_ptr<StagingArea>> StagingArea::open(FileCalls& calls, const fs::path& staging) {
  // One process at a time: a folder just made must not look stale before it is locked.
  const OpenFile turn = open_folder(calls, staging);
  if (!turn.is_open()) return file_error(staging, "cannot open this folder", errno);
  if (calls.flock(turn.descriptor(), LOCK_EX) != 0) return file_error(staging, "cannot lock this folder", errno);
  remove_stale_folders(calls, staging);

  std::string own = (staging / "process-XXXXXX").string();
  if (!calls.mkdtemp(own.data())) return file_error(staging, "cannot write in this folder", errno);
  OpenFile lock = open_folder(calls, own);
  if (!lock.is_open() || calls.flock(lock.descriptor(), LOCK_EX | LOCK_NB) != 0) {
    const int reason = errno;
    calls.rmdir(own.c_str());
    return file_error(own, "cannot lock this folder", reason);
  }
  return std::unique_ptr<StagingArea>(new StagingArea(calls, own, std::move(lock)));
}

StagingArea::StagingArea(FileCalls& calls, fs::path folder, OpenFile lock)
    : calls_(calls), folder_(std::move(folder)), lock_(std::move(lock)) {}

StagingArea::~StagingArea() {
  remove_flat_folder(calls_, folder_);
}

bool StagingArea::may_be_running(const std::string& process) const {
  if (process == process_name()) return true;
  if (!is_key_segment(process)) return false;  // no folder is called so
  const OpenFile folder = open_folder(calls_, folder_.parent_path() / process);
  if (!folder.is_open()) return errno != ENOENT;
  return calls_.flock(folder.descriptor(), LOCK_SH | LOCK_NB) != 0;
}

Result<std::unique_ptr<StagedFile>> StagingArea::stage() {
  const fs::path path = folder_ / std::to_string(serial_.fetch_add(1));
  OpenFile file(calls_, calls_.open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL, kFileMode));
  if (!file.is_open()) return file_error(path, "cannot make this file", errno);
  return std::unique_ptr<StagedFile>(std::make_unique<DirStagedFile>(calls_, path));
}

}  // namespace geosis::server
