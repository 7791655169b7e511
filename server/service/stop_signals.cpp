#include "server/service/stop_signals.h"

#include <atomic>
#include <cstdlib>
#include <ctime>
#include <thread>

#include <pthread.h>

namespace geosis::server {

StopSignals::StopSignals() {
  sigemptyset(&set_);
  sigaddset(&set_, SIGTERM);
  sigaddset(&set_, SIGINT);
  pthread_sigmask(SIG_BLOCK, &set_, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
}

void StopSignals::wait() {
  int number = 0;
  sigwait(&set_, &number);
}

bool StopSignals::wait_for(std::chrono::milliseconds time) {
  const std::timespec limit{time.count() / 1000, (time.count() % 1000) * 1'000'000};
  return sigtimedwait(&set_, nullptr, &limit) > 0;
}

void stop_or_exit(StopSignals& signals, std::chrono::milliseconds time, const std::function<void()>& stop) {
  const auto end = std::chrono::steady_clock::now() + time;
  std::atomic<bool> is_stopped{false};
  std::jthread stopping([&] {
    stop();
    is_stopped = true;
  });
  while (!is_stopped) {
    const bool is_late = std::chrono::steady_clock::now() > end;
    if (signals.wait_for(std::chrono::milliseconds(20)) || is_late) std::_Exit(EXIT_FAILURE);
  }
}

}  // namespace geosis::server
