#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/volume/formats/byte_reader.h"
#include "engine/volume/formats/byte_source.h"
#include "engine/volume/formats/segy_headers.h"

namespace geosis {

/// A number of the trace header: 1-based byte and width, 2 or 4 bytes, signed.
struct HeaderWord {
  int byte = 0, width = 4;

  bool operator==(const HeaderWord&) const = default;
  std::int64_t in(const HeaderView& header) const {
    return width == 2 ? std::int64_t{header.at<std::int16_t>(byte)} : std::int64_t{header.at<std::int32_t>(byte)};
  }
};

/// What the traces say in one word: smallest, largest, and the step that leads from each to each.
class WordRange {
 public:
  void add(std::int64_t value);

  std::int64_t min() const { return min_; }
  std::int64_t max() const { return max_; }
  std::int64_t step() const { return step_; }  ///< 0 when the word is the same in all traces
  std::int64_t count() const { return step_ == 0 ? 1 : (max_ - min_) / step_ + 1; }
  bool varies() const { return step_ != 0; }

 private:
  bool empty_ = true;
  std::int64_t first_ = 0, min_ = 0, max_ = 0, step_ = 0;
};

struct TraceScan {
  std::vector<HeaderWord> words;
  std::vector<WordRange> ranges;  ///< of the words
  WordRange offset;               ///< source to receiver, byte 37
  WordRange samples;              ///< byte 115
  WordRange delay;                ///< byte 109
  std::array<std::byte, kTraceHeaderBytes> first_header{};

  const WordRange& range(HeaderWord word) const;  ///< of one of the words
};

/// Calls visit with every trace's header, in file order. errors: unavailable, cancelled, and what reading gives.
Result<void> for_each_trace_header(const ByteSource& source, const SegyLayout& layout, Progress& progress,
                                   const std::function<void(const HeaderView&)>& visit);

/// Ranges of the words over all traces, in constant memory.
Result<TraceScan> scan_traces(const ByteSource& source, const SegyLayout& layout, std::span<const HeaderWord> words,
                              Progress& progress);

inline HeaderView trace_header_view(std::span<const std::byte> header, const SegyLayout& layout) {
  return {header, 1, layout.big_endian};
}

}  // namespace geosis
