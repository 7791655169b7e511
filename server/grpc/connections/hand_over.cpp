#include "server/grpc/connections/hand_over.h"

#include <algorithm>
#include <utility>

namespace geosis::server::rpc {

HandOver::HandOver(std::vector<Lane> lanes, std::chrono::milliseconds patience)
    : lanes_(std::move(lanes)), patience_(patience), kept_(lanes_.size()) {
  try {
    for (std::size_t lane = 0; lane < lanes_.size(); ++lane) threads_.emplace_back([this, lane] { run(lane); });
  } catch (...) {
    stop();
    throw;
  }
}

bool HandOver::has_room() {
  const std::lock_guard lock(mutex_);
  return waiting_.size() < lanes_.size();
}

void HandOver::hand(Descriptor socket, std::string name) {
  {
    const std::lock_guard lock(mutex_);
    if (is_stopping_) return;
    waiting_.push_back({std::move(socket), std::move(name)});
  }
  came_.notify_one();
}

void HandOver::run(std::size_t lane) {
  std::unique_lock lock(mutex_);
  for (;;) {
    came_.wait(lock, [&] { return is_stopping_ || !waiting_.empty(); });
    if (is_stopping_) return;
    Waiting next = std::move(waiting_.front());
    waiting_.pop_front();
    kept_[lane] = Kept{LentSocket(next.socket.number()), std::move(next.name), Clock::now(), false};
    lock.unlock();
    lanes_[lane](std::move(next.socket));
    lock.lock();
    kept_[lane] = std::nullopt;
    left_.notify_all();
  }
}

std::optional<std::string> HandOver::stuck() {
  const std::lock_guard lock(mutex_);
  if (waiting_.empty()) return std::nullopt;
  Kept* longest = nullptr;
  for (auto& kept : kept_) {
    if (!kept) return std::nullopt;  // a lane that is about to take what waits
    if (longest == nullptr || kept->since < longest->since) longest = &*kept;
  }
  if (longest == nullptr || longest->was_named || Clock::now() - longest->since < patience_) return std::nullopt;
  longest->was_named = true;
  return longest->name;
}

void HandOver::stop() {
  {
    std::unique_lock lock(mutex_);
    is_stopping_ = true;
    waiting_.clear();
    came_.notify_all();
    const auto is_kept = [](const auto& kept) { return kept.has_value(); };
    left_.wait_for(lock, patience_, [&] { return std::none_of(kept_.begin(), kept_.end(), is_kept); });
    for (const auto& kept : kept_) {
      if (kept) kept->socket.reset();
    }
  }
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

}  // namespace geosis::server::rpc
