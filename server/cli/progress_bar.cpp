#include "server/cli/progress_bar.h"

#include <algorithm>
#include <csignal>
#include <cstdio>

#include <unistd.h>

namespace geosis::server {
namespace {

volatile std::sig_atomic_t stop_requested = 0;

extern "C" void request_stop(int signal) {
  stop_requested = 1;
  std::signal(signal, SIG_DFL);  // asked twice: do not wait
}

constexpr auto kRefresh = std::chrono::milliseconds(50);
constexpr int kWidth = 40;

}  // namespace

ProgressBar::ProgressBar() : is_terminal_(isatty(STDERR_FILENO) == 1) {
  std::signal(SIGINT, request_stop);
  std::signal(SIGTERM, request_stop);
}

ProgressBar::~ProgressBar() {
  clear();
}

void ProgressBar::report(const char* stage, double fraction) {
  if (!is_terminal_) return;
  const std::lock_guard lock(mutex_);
  const auto now = std::chrono::steady_clock::now();
  if (is_shown_ && shown_stage_ == stage && now - shown_at_ < kRefresh) return;
  shown_stage_ = stage;
  shown_at_ = now;
  is_shown_ = true;
  const int done = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * kWidth);
  std::fprintf(stderr, "\r\033[K%-10s [%s%s]", stage, std::string(static_cast<std::size_t>(done), '#').c_str(),
               std::string(static_cast<std::size_t>(kWidth - done), ' ').c_str());
  std::fflush(stderr);
}

bool ProgressBar::cancelled() const {
  return stop_requested != 0;
}

void ProgressBar::clear() {
  const std::lock_guard lock(mutex_);
  if (is_shown_) std::fputs("\r\033[K", stderr);
  is_shown_ = false;
}

}  // namespace geosis::server
