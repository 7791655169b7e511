#include "engine/base/parallel.h"

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#ifdef GEOSIS_THREAD_SANITIZER
extern "C" void __tsan_acquire(void* address);
extern "C" void __tsan_release(void* address);
#endif

namespace geosis {
namespace {

/// Tells the thread sanitizer, which does not see into TBB, what parallel_for promises: tasks begin after all that the
/// caller has done, and the caller goes on after all that they have.
class Handover {
 public:
#ifdef GEOSIS_THREAD_SANITIZER
  void give() {
    __tsan_release(&place_);
  }
  void take() {
    __tsan_acquire(&place_);
  }

 private:
  char place_ = 0;
#else
  void give() {}
  void take() {}
#endif
};

thread_local LoopPriority current_priority = LoopPriority::normal;

tbb::task_arena::priority arena_priority(LoopPriority priority) {
  switch (priority) {
    case LoopPriority::low:
      return tbb::task_arena::priority::low;
    case LoopPriority::normal:
      return tbb::task_arena::priority::normal;
    case LoopPriority::high:
      return tbb::task_arena::priority::high;
  }
  return tbb::task_arena::priority::normal;
}

/// Arenas that loops have used and that wait for the next. TBB destroys an arena only when its workers have come and
/// gone: of loops that end before any worker comes, on a machine that is busy, it keeps all, some 7 KB each.
class IdleArenas {
 public:
  /// Never destroyed: threads may still run loops when the process already ends.
  static IdleArenas& of_process() {
    static auto& arenas = *new IdleArenas;
    return arenas;
  }

  std::unique_ptr<tbb::task_arena> take(int threads, LoopPriority priority) {
    {
      const std::lock_guard lock(mutex_);
      auto& arenas = arenas_[{threads, priority}];
      if (!arenas.empty()) {
        auto arena = std::move(arenas.back());
        arenas.pop_back();
        return arena;
      }
    }
    return std::make_unique<tbb::task_arena>(threads, 1, arena_priority(priority));
  }

  void give_back(int threads, LoopPriority priority, std::unique_ptr<tbb::task_arena> arena) {
    const std::lock_guard lock(mutex_);
    arenas_[{threads, priority}].push_back(std::move(arena));
  }

 private:
  std::mutex mutex_;
  std::map<std::pair<int, LoopPriority>, std::vector<std::unique_ptr<tbb::task_arena>>> arenas_;
};

}  // namespace

LoopPriorityScope::LoopPriorityScope(LoopPriority priority) : before_(current_priority) {
  current_priority = priority;
}

LoopPriorityScope::~LoopPriorityScope() {
  current_priority = before_;
}

int default_threads() {
  return tbb::info::default_concurrency();
}

void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& task) {
  if (threads <= 1 || count <= 1) {
    for (std::size_t i = 0; i < count; ++i) task(i);
    return;
  }
  // TBB gives no more threads than processors unless it is told to; more are asked for to test that results agree.
  std::optional<tbb::global_control> allow;
  if (threads > default_threads())
    allow.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  const LoopPriority priority = current_priority;
  auto arena = IdleArenas::of_process().take(threads, priority);
  Handover begin, end;
  begin.give();
  arena->execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
          begin.take();
          const LoopPriorityScope nested(priority);
          for (std::size_t i = range.begin(); i != range.end(); ++i) task(i);
          end.give();
        },
        tbb::simple_partitioner());
  });
  end.take();
  IdleArenas::of_process().give_back(threads, priority, std::move(arena));
}

}  // namespace geosis
