#include "server/http/upload_threads.h"

#include <system_error>
#include <utility>

namespace geosis::server::http {

bool UploadThreads::start(std::uint64_t connection, std::function<void()> work) {
  auto slot = slots_.take();
  if (!slot) return false;
  try {
    threads_.emplace(connection, Running{std::thread(std::move(work)), *std::move(slot)});
  } catch (const std::system_error&) {
    return false;
  }
  return true;
}

void UploadThreads::finished(std::uint64_t connection) {
  const auto thread = threads_.find(connection);
  if (thread == threads_.end()) return;
  thread->second.thread.join();
  threads_.erase(thread);
}

void UploadThreads::join_all() {
  for (auto& [connection, running] : threads_) running.thread.join();
  threads_.clear();
}

}  // namespace geosis::server::http
