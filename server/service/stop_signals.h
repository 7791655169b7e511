#pragma once

#include <chrono>
#include <csignal>
#include <functional>

namespace geosis::server {

/// SIGTERM and SIGINT come to whoever waits for them here, and to no other thread. Made before the first thread starts,
/// so that every thread inherits the mask.
class StopSignals {
 public:
  StopSignals();
  void wait();
  /// True when one came in time.
  bool wait_for(std::chrono::milliseconds time);

 private:
  sigset_t set_{};
};

/// Runs `stop` and waits for it; a second signal ends the process at once, and so does work that does not end in time:
/// nothing acknowledged is lost by that.
void stop_or_exit(StopSignals& signals, std::chrono::milliseconds time, const std::function<void()>& stop);

}  // namespace geosis::server
