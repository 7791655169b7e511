#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "server/app/extractions/extractions.h"
#include "server/app/volumes/volumes.h"

namespace geosis::server {

/// Removes what processes that were killed left in the store, on a thread of its own: once at the start, then every
/// hour. Volumes and extractions outlive it.
class Housekeeping {
 public:
  Housekeeping(Volumes& volumes, Extractions& extractions, std::chrono::seconds interval = std::chrono::hours(1));

 private:
  std::mutex mutex_;
  std::condition_variable_any woken_;
  std::jthread thread_;
};

}  // namespace geosis::server
