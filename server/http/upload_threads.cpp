#include "server/http/upload_threads.h"

#include <system_error>
#include <utility>

namespace geosis::server::http {

bool UploadThreads::start(std::uint64_t connection, std::function<void()> work) {
  if (!has_room()) return false;
  try {
    threads_.emplace(connection, std::thread(std::move(work)));
  } catch (const std::system_error&) {
    return false;
  }
  return true;
}

void UploadThreads::finished(std::uint64_t connection) {
  const auto thread = threads_.find(connection);
  if (thread == threads_.end()) return;
  thread->second.join();
  threads_.erase(thread);
}

void UploadThreads::join_all() {
  for (auto& [connection, thread] : threads_) thread.join();
  threads_.clear();
}

}  // namespace geosis::server::http
