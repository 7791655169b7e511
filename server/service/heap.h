#pragma once

#include <atomic>
#include <chrono>

namespace geosis::server {

/// Lets threads share the allocator's arenas: at its default of eight a processor, each keeps what its busiest moment
/// needed, and a server that has seen every mix of work holds twice what is in use. Before the first thread starts.
void share_heap_arenas();

/// Gives memory that jobs have freed back to the system: the allocator would keep it in the arenas of the threads that
/// used it, and the next job takes it in others. At most once a second; any thread may call it.
class HeapTrimmer {
 public:
  void operator()();

 private:
  std::atomic<std::chrono::steady_clock::rep> last_{0};
};

}  // namespace geosis::server
