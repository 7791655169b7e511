#include "engine/missing/node_set.h"

#include <algorithm>
#include <utility>

#include "engine/base/parallel.h"

namespace geosis {
namespace {

using Square = std::array<std::uint64_t, 64>;

// Column `word` of 64 lines from `first` in steps of `stride` lines; lines from `count` on are empty.
Square gather(const BitLines& lines, std::size_t first, std::size_t stride, std::int32_t count, std::size_t word) {
  Square square{};
  for (std::int32_t t = 0; t < std::min(count, 64); ++t)
    square[static_cast<std::size_t>(t)] = lines.line(first + static_cast<std::size_t>(t) * stride)[word];
  return square;
}

void scatter(const Square& square, BitLines& lines, std::size_t first, std::int32_t count, std::size_t word) {
  for (std::int32_t t = 0; t < std::min(count, 64); ++t)
    lines.line(first + static_cast<std::size_t>(t))[word] = square[static_cast<std::size_t>(t)];
}

}  // namespace

NodeSet::NodeSet(GridShape shape, BitLines along_k, int threads, const Progress& progress) : shape_(shape) {
  along_[2] = std::move(along_k);
  const auto samples = static_cast<std::size_t>(shape.samples);
  if (shape.crosslines > 1) {
    along_[1] = BitLines(static_cast<std::size_t>(shape.inlines) * samples, shape.crosslines);
    parallel_for(static_cast<std::size_t>(shape.inlines), threads, [&](std::size_t i) {
      if (!progress.cancelled()) turn_inline(static_cast<std::int32_t>(i));
    });
  }
  if (shape.inlines > 1) {
    along_[0] = BitLines(static_cast<std::size_t>(shape.crosslines) * samples, shape.inlines);
    parallel_for(static_cast<std::size_t>(shape.crosslines), threads, [&](std::size_t j) {
      if (!progress.cancelled()) turn_crossline(static_cast<std::int32_t>(j));
    });
  }
}

void NodeSet::turn_inline(std::int32_t i) {
  for (std::int32_t j = 0; j < shape_.crosslines; j += 64) {
    for (std::int32_t k = 0; k < shape_.samples; k += 64) {
      const auto word = static_cast<std::size_t>(k / 64);
      Square square = gather(along_[2], line(2, {i, j, k}), 1, shape_.crosslines - j, word);
      transpose(square);
      scatter(square, along_[1], line(1, {i, j, k}), shape_.samples - k, static_cast<std::size_t>(j / 64));
    }
  }
}

void NodeSet::turn_crossline(std::int32_t j) {
  const auto stride = static_cast<std::size_t>(shape_.crosslines);
  for (std::int32_t i = 0; i < shape_.inlines; i += 64) {
    for (std::int32_t k = 0; k < shape_.samples; k += 64) {
      const auto word = static_cast<std::size_t>(k / 64);
      Square square = gather(along_[2], line(2, {i, j, k}), stride, shape_.inlines - i, word);
      transpose(square);
      scatter(square, along_[0], line(0, {i, j, k}), shape_.samples - k, static_cast<std::size_t>(i / 64));
    }
  }
}

}  // namespace geosis
