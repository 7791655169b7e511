#include "server/app/derived/key_turns.h"

#include <chrono>

namespace geosis::server {
namespace {

constexpr std::chrono::milliseconds kAskAgain{50};

}  // namespace

bool KeyTurns::Turn::take(KeyTurns& turns, const BlobKey& key, const Progress& progress) {
  std::unique_lock lock(turns.mutex_);
  while (turns.taken_.contains(key)) {
    if (progress.cancelled()) return false;
    turns.turn_ended_.wait_for(lock, kAskAgain);
  }
  turns.taken_.insert(key);
  turns_ = &turns;
  key_ = key;
  return true;
}

KeyTurns::Turn::~Turn() {
  if (turns_ == nullptr) return;
  const std::lock_guard lock(turns_->mutex_);
  turns_->taken_.erase(key_);
  turns_->turn_ended_.notify_all();
}

}  // namespace geosis::server
