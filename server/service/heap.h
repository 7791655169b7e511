#pragma once

#include <atomic>
#include <chrono>

namespace geosis::server {

/// Gives memory that jobs have freed back to the system: the allocator would keep it in the arenas of the threads that
/// used it, and the next job takes it in others. At most once a second; any thread may call it.
class HeapTrimmer {
 public:
  void operator()();

 private:
  std::atomic<std::chrono::steady_clock::rep> last_{0};
};

}  // namespace geosis::server
