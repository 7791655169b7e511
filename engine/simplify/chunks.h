#pragma once

#include <cstddef>

#include "engine/base/parallel.h"

namespace geosis {

/// Into how many pieces work is cut. Fixed, so that nothing depends on the number of threads.
inline constexpr std::size_t kChunks = 16;

struct Range {
  std::size_t begin, end;
};

inline Range chunk_of(std::size_t size, std::size_t chunk) {
  return {size * chunk / kChunks, size * (chunk + 1) / kChunks};
}

/// Calls task(chunk, begin, end) for the pieces of 0 ... size - 1.
template <class Task>
void for_chunks(std::size_t size, int threads, const Task& task) {
  parallel_for(kChunks, threads, [&](std::size_t chunk) {
    const auto [begin, end] = chunk_of(size, chunk);
    task(chunk, begin, end);
  });
}

}  // namespace geosis
