#include "engine/volume/formats/trace_scan.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <utility>

namespace geosis {
namespace {

constexpr std::uint64_t kReadBytes = 1 << 20;
/// Shorter traces are read whole, many at a time; of longer ones only the header.
constexpr std::uint64_t kLongTrace = 2048;
constexpr std::uint64_t kTracesBetweenChecks = 1024;

}  // namespace

void WordRange::add(std::int64_t value) {
  if (empty_) {
    first_ = min_ = max_ = value;
    empty_ = false;
    return;
  }
  min_ = std::min(min_, value);
  max_ = std::max(max_, value);
  if (const std::int64_t apart = value - first_; step_ == 0 || apart % step_ != 0) step_ = std::gcd(step_, apart);
}

const WordRange& TraceScan::range(HeaderWord word) const {
  const auto found = std::find(words.begin(), words.end(), word);
  assert(found != words.end());
  return ranges[static_cast<std::size_t>(found - words.begin())];
}

Result<void> for_each_trace_header(const ByteSource& source, const SegyLayout& layout, Progress& progress,
                                   const std::function<void(const HeaderView&)>& visit) {
  const std::uint64_t stride = layout.trace_bytes();
  const std::uint64_t batch = stride <= kLongTrace ? kReadBytes / stride : 1;
  std::vector<std::byte> buffer(batch == 1 ? kTraceHeaderBytes : batch * stride);
  for (std::uint64_t trace = 0; trace < layout.traces; trace += batch) {
    if (trace % kTracesBetweenChecks < batch && progress.cancelled()) return Error{ErrorCode::cancelled, "cancelled"};
    const std::uint64_t count = std::min(batch, layout.traces - trace);
    const std::span<std::byte> bytes = std::span(buffer).first(batch == 1 ? kTraceHeaderBytes : count * stride);
    if (auto read = source.read_at(layout.first_trace + trace * stride, bytes); !read) return read;
    for (std::uint64_t t = 0; t < count; ++t)
      visit(trace_header_view(bytes.subspan(t * stride, kTraceHeaderBytes), layout));
  }
  return {};
}

Result<TraceScan> scan_traces(const ByteSource& source, const SegyLayout& layout, std::span<const HeaderWord> words,
                              Progress& progress) {
  TraceScan scan;
  scan.words.assign(words.begin(), words.end());
  scan.ranges.resize(words.size());
  if (auto read = source.read_at(layout.first_trace, scan.first_header); !read) return std::move(read).error();
  auto visited = for_each_trace_header(source, layout, progress, [&](const HeaderView& header) {
    for (std::size_t w = 0; w < words.size(); ++w) scan.ranges[w].add(words[w].in(header));
    scan.offset.add(header.at<std::int32_t>(37));
    scan.samples.add(header.at<std::uint16_t>(115));
    scan.delay.add(header.at<std::int16_t>(109));
  });
  if (!visited) return std::move(visited).error();
  return scan;
}

}  // namespace geosis
