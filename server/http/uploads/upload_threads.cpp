#include "server/http/uploads/upload_threads.h"

#include <algorithm>
#include <system_error>
#include <utility>

namespace geosis::server::http {

bool UploadThreads::has_room(const std::string& peer) const {
  const auto of_peer =
      std::count_if(uploads_.begin(), uploads_.end(), [&](const auto& u) { return u.second.peer == peer; });
  return slots_.has_room() && static_cast<std::size_t>(of_peer) < slots_.most() - slots_.most() / 4;
}

bool UploadThreads::start(std::uint64_t connection, const std::string& peer, std::function<void()> work) {
  if (!has_room(peer)) return false;
  auto slot = slots_.take();
  if (!slot) return false;
  try {
    uploads_.emplace(connection, Upload{peer, std::thread(std::move(work)), *std::move(slot)});
  } catch (const std::system_error&) {
    return false;
  }
  return true;
}

void UploadThreads::finished(std::uint64_t connection) {
  const auto upload = uploads_.find(connection);
  if (upload == uploads_.end()) return;
  upload->second.thread.join();
  uploads_.erase(upload);
}

void UploadThreads::join_all() {
  for (auto& [connection, upload] : uploads_) upload.thread.join();
  uploads_.clear();
}

}  // namespace geosis::server::http
