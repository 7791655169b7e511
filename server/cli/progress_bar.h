#pragma once

#include <chrono>
#include <mutex>
#include <string>

#include "engine/base/progress.h"

namespace geosis::server {

/// Shows a bar on stderr when that is a terminal, and is cancelled by Ctrl-C (SIGINT) or SIGTERM.
class ProgressBar final : public Progress {
 public:
  ProgressBar();  ///< from here on the two signals cancel instead of killing, so that files can be cleaned up
  ~ProgressBar() override;

  void report(const char* stage, double fraction) override;
  bool cancelled() const override;
  /// Takes the bar away, for what is printed next.
  void clear();

 private:
  const bool is_terminal_;
  std::mutex mutex_;
  std::string shown_stage_;
  std::chrono::steady_clock::time_point shown_at_;
  bool is_shown_ = false;
};

}  // namespace geosis::server
