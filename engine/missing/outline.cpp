#include "engine/missing/outline.h"

#include <algorithm>
#include <cstddef>

namespace geosis {
namespace {

// Marks what lies between the first and the last valid trace of a line of traces.
void mark_between(const std::vector<std::uint8_t>& valid, std::size_t first, std::size_t stride, std::int32_t count,
                  std::vector<std::uint8_t>& between) {
  const auto at = [&](std::int32_t n) { return first + static_cast<std::size_t>(n) * stride; };
  std::int32_t begin = 0, end = count;
  while (begin < end && !valid[at(begin)]) ++begin;
  while (end > begin && !valid[at(end - 1)]) --end;
  for (std::int32_t n = begin; n < end; ++n) ++between[at(n)];
}

}  // namespace

std::vector<std::uint8_t> traces_inside(GridShape shape, const BitLines& valid) {
  const auto crosslines = static_cast<std::size_t>(shape.crosslines);
  std::vector<std::uint8_t> is_valid(static_cast<std::size_t>(shape.inlines) * crosslines), inside(is_valid.size());
  for (std::size_t trace = 0; trace < is_valid.size(); ++trace)
    is_valid[trace] = std::ranges::any_of(valid.line(trace), [](std::uint64_t word) { return word != 0; });
  for (std::int32_t i = 0; i < shape.inlines; ++i)
    mark_between(is_valid, static_cast<std::size_t>(i) * crosslines, 1, shape.crosslines, inside);
  for (std::int32_t j = 0; j < shape.crosslines; ++j)
    mark_between(is_valid, static_cast<std::size_t>(j), crosslines, shape.inlines, inside);
  for (std::uint8_t& sides : inside) sides = sides == 2;
  return inside;
}

}  // namespace geosis
