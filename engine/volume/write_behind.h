#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <stop_token>
#include <thread>

#include "engine/volume/mapped_file.h"

namespace geosis {

/// Brings parts of a file to the disk while others are still computed. Beginning to write waits for the disk's queue:
/// a thread of its own does, nobody else.
class WriteBehind {
 public:
  /// file must live as long.
  explicit WriteBehind(const MappedFile& file);
  /// Parts that have not begun are left to the system.
  ~WriteBehind() = default;

  /// These bytes will not change any more.
  void add(std::uint64_t offset, std::uint64_t bytes);

 private:
  struct Part {
    std::uint64_t offset = 0, bytes = 0;
  };
  void run(const std::stop_token& stop);

  const MappedFile& file_;
  std::mutex mutex_;
  std::condition_variable_any added_;
  std::deque<Part> parts_;
  std::jthread thread_;  // last: it ends before what it uses
};

}  // namespace geosis
