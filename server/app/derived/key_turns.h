#pragma once

#include <condition_variable>
#include <mutex>
#include <set>

#include "engine/base/progress.h"
#include "server/store/blob_store.h"

namespace geosis::server {

/// Lets one thread at a time make what is stored under a key; others who want it wait for their turn.
class KeyTurns {
 public:
  /// The right to make it, while it lives.
  class Turn {
   public:
    Turn() = default;
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;
    ~Turn();

    /// Waits for it; false when cancelled.
    bool take(KeyTurns& turns, const BlobKey& key, const Progress& progress);

   private:
    KeyTurns* turns_ = nullptr;
    BlobKey key_;
  };

 private:
  std::mutex mutex_;
  std::condition_variable turn_ended_;
  std::set<BlobKey> taken_;
};

}  // namespace geosis::server
