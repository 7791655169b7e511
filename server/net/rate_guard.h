#pragma once

#include <chrono>
#include <cstdint>

namespace geosis::server {

/// Judges a peer's rate, window by window; only time spent waiting for the peer counts.
class RateGuard {
 public:
  RateGuard(std::uint64_t bytes_per_second, std::chrono::milliseconds window)
      : bytes_per_second_(bytes_per_second), window_(window) {}

  void set_rate(std::uint64_t bytes_per_second) { bytes_per_second_ = bytes_per_second; }
  /// Notes that `bytes` moved after `waited`. False when a window ended in which too few did.
  bool add(std::uint64_t bytes, std::chrono::steady_clock::duration waited) {
    bytes_ += bytes;
    waited_ += waited;
    if (waited_ < window_) return true;
    const double seconds = std::chrono::duration<double>(waited_).count();
    const bool is_fast_enough = static_cast<double>(bytes_) >= static_cast<double>(bytes_per_second_) * seconds;
    bytes_ = 0;
    waited_ = {};
    return is_fast_enough;
  }

 private:
  std::uint64_t bytes_per_second_;
  std::chrono::milliseconds window_;
  std::uint64_t bytes_ = 0;
  std::chrono::steady_clock::duration waited_{};
};

}  // namespace geosis::server
