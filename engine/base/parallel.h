#pragma once

#include <cstddef>
#include <functional>

namespace geosis {

/// Threads a stage may use when its caller does not say: the processors this process may run on.
int default_threads();

/// Calls task(0) ... task(count - 1), at most `threads` at a time, and returns when all are done.
///
/// Tasks start in any order, so a task writes only to its own place; threads = 1 runs them in order, inline.
/// Tasks must not throw.
void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& task);

/// How the parallel loops of a thread compete for the process's threads with the loops of others: free threads help the
/// highest first.
enum class LoopPriority { low, normal, high };

/// Sets the priority of the loops that the calling thread starts while this lives, nested ones included. Default:
/// normal.
class [[nodiscard]] LoopPriorityScope {
 public:
  explicit LoopPriorityScope(LoopPriority priority);
  LoopPriorityScope(const LoopPriorityScope&) = delete;
  LoopPriorityScope& operator=(const LoopPriorityScope&) = delete;
  ~LoopPriorityScope();

 private:
  LoopPriority before_;
};

}  // namespace geosis
