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

}  // namespace geosis
