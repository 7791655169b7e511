#include "server/service/heap.h"

#include <algorithm>
#include <thread>

#include <malloc.h>

namespace geosis::server {

void share_heap_arenas() {
  constexpr int kFewest = 2;
  const int processors = static_cast<int>(std::thread::hardware_concurrency());
  ::mallopt(M_ARENA_MAX, std::max(kFewest, processors / 2));
}

void HeapTrimmer::operator()() {
  using Clock = std::chrono::steady_clock;
  const auto now = Clock::now().time_since_epoch().count();
  auto last = last_.load();
  constexpr auto kInterval = std::chrono::duration_cast<Clock::duration>(std::chrono::seconds(1)).count();
  if (now - last < kInterval || !last_.compare_exchange_strong(last, now)) return;
  ::malloc_trim(0);
}

}  // namespace geosis::server
