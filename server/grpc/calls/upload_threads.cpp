#include "server/grpc/calls/upload_threads.h"

#include <algorithm>
#include <memory>
#include <system_error>
#include <utility>

namespace geosis::server::rpc {

bool UploadThreads::start(const std::string& peer, std::function<void()> work) {
  const std::lock_guard lock(mutex_);
  join_ended();
  const auto of_peer =
      std::count_if(threads_.begin(), threads_.end(), [&](const Running& r) { return r.peer == peer; });
  if (static_cast<std::size_t>(of_peer) >= slots_.most() - slots_.most() / 4) return false;
  auto slot = slots_.take();
  if (!slot) return false;
  Running& running = threads_.emplace_back();
  running.peer = peer;
  try {
    running.thread = std::thread(
        [this, &running, held = std::make_shared<Slots::Slot>(*std::move(slot)), work = std::move(work)]() mutable {
          work();
          work = nullptr;  // what it holds goes before its place is free
          held.reset();
          const std::lock_guard ended(mutex_);
          running.has_ended = true;
        });
  } catch (const std::system_error&) {
    threads_.pop_back();
    return false;
  }
  return true;
}

/// A thread that has said so is about to return: joining it takes no time.
void UploadThreads::join_ended() {
  threads_.remove_if([](Running& running) {
    if (!running.has_ended) return false;
    running.thread.join();
    return true;
  });
}

void UploadThreads::join_all() {
  std::list<Running> all;
  {
    const std::lock_guard lock(mutex_);
    all.splice(all.end(), threads_);  // elements stay where they are
  }
  for (Running& running : all) running.thread.join();
}

}  // namespace geosis::server::rpc
