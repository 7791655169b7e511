#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace geosis::server::rpc {

/// Sums up the connections that were ended for flooding, so that a flood is a line a second in a log; and notices when
/// it is over.
class FloodReports {
 public:
  using Clock = std::chrono::steady_clock;
  /// connections   ended since it was last said.  last   the name of one of them.
  using Say = std::function<void(std::size_t connections, const std::string& last)>;

  /// over   called once when none was ended for a second.
  FloodReports(Say say, std::function<void()> over) : say_(std::move(say)), over_(std::move(over)) {}

  void note(const std::vector<std::string>& ended, Clock::time_point now) {
    if (ended.empty()) return;
    count_ += ended.size();
    last_ = ended.back();
    noted_ = now;
    is_over_ = false;
  }

  /// To be called often.
  void tick(Clock::time_point now) {
    if (count_ > 0 && now - said_ >= kInterval) {
      say_(std::exchange(count_, 0), last_);
      said_ = now;
    }
    if (!is_over_ && now - noted_ >= kInterval) {
      is_over_ = true;
      over_();
    }
  }

 private:
  static constexpr std::chrono::seconds kInterval{1};

  const Say say_;
  const std::function<void()> over_;
  std::size_t count_ = 0;
  std::string last_;
  Clock::time_point noted_{}, said_{};
  bool is_over_ = true;
};

}  // namespace geosis::server::rpc
