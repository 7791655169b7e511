#include "engine/missing/gaps/outline.h"

#include <algorithm>
#include <cstddef>

namespace geosis {
namespace {

/// One byte a trace.
using Traces = std::vector<std::uint8_t>;

constexpr std::uint8_t kBetween = 1, kEmptyLine = 2;

/// Marks the traces of one line: those from the first to the last chosen one; all, differently, if none is chosen.
void mark_line(const Traces& chosen, std::size_t first, std::size_t stride, std::int32_t count, Traces& marks) {
  const auto at = [&](std::int32_t n) { return first + static_cast<std::size_t>(n) * stride; };
  std::int32_t begin = 0, end = count;
  while (begin < end && chosen[at(begin)] == 0) ++begin;
  while (end > begin && chosen[at(end - 1)] == 0) --end;
  const bool empty = begin == end;
  if (empty) begin = 0, end = count;
  for (std::int32_t n = begin; n < end; ++n) marks[at(n)] = empty ? kEmptyLine : kBetween;
}

Traces mark_along_inlines(GridShape shape, const Traces& chosen) {
  Traces marks(chosen.size());
  const auto crosslines = static_cast<std::size_t>(shape.crosslines);
  for (std::int32_t i = 0; i < shape.inlines; ++i)
    mark_line(chosen, static_cast<std::size_t>(i) * crosslines, 1, shape.crosslines, marks);
  return marks;
}

Traces mark_along_crosslines(GridShape shape, const Traces& chosen) {
  Traces marks(chosen.size());
  const auto crosslines = static_cast<std::size_t>(shape.crosslines);
  for (std::size_t j = 0; j < crosslines; ++j) mark_line(chosen, j, crosslines, shape.inlines, marks);
  return marks;
}

}  // namespace

std::vector<std::uint8_t> traces_inside(GridShape shape, const BitLines& valid) {
  Traces inside(static_cast<std::size_t>(shape.inlines) * static_cast<std::size_t>(shape.crosslines));
  for (std::size_t trace = 0; trace < inside.size(); ++trace)
    inside[trace] = std::ranges::any_of(valid.line(trace), [](std::uint64_t word) { return word != 0; });
  const Traces on_inline = mark_along_inlines(shape, inside), on_crossline = mark_along_crosslines(shape, inside);
  const auto is_crossing = [&](std::size_t trace) {
    return on_inline[trace] == kEmptyLine && on_crossline[trace] == kEmptyLine;
  };
  for (std::size_t trace = 0; trace < inside.size(); ++trace)
    inside[trace] = on_inline[trace] != 0 && on_crossline[trace] != 0 && !is_crossing(trace);
  const Traces again_inline = mark_along_inlines(shape, inside), again_crossline = mark_along_crosslines(shape, inside);
  for (std::size_t trace = 0; trace < inside.size(); ++trace)
    if (is_crossing(trace)) inside[trace] = again_inline[trace] == kBetween && again_crossline[trace] == kBetween;
  return inside;
}

}  // namespace geosis
