#include "server/app/housekeeping.h"

namespace geosis::server {

// What cannot be removed now is found again the next time.
Housekeeping::Housekeeping(Volumes& volumes, Extractions& extractions, std::chrono::seconds interval)
    : thread_([this, &volumes, &extractions, interval](const std::stop_token& stop) {
        while (!stop.stop_requested()) {
          static_cast<void>(volumes.collect_garbage());
          static_cast<void>(extractions.collect_garbage());
          std::unique_lock lock(mutex_);
          woken_.wait_for(lock, stop, interval, [] { return false; });
        }
      }) {}

}  // namespace geosis::server
