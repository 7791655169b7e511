#include "engine/volume/formats/raw_slices.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "engine/base/digest.h"
#include "engine/base/parallel.h"
#include "engine/volume/mapped_file.h"

namespace geosis {
namespace {

constexpr std::uint64_t kPieceBytes = 1 << 20;
constexpr std::int32_t kSlots = 2 * kBrickSamples;  // one layer of bricks is turned while the next arrives

/// The slices that arrived last, in a file without a name: slice k in slot k modulo the number of slots.
class SliceRing {
 public:
  SliceRing(std::unique_ptr<MappedFile> file, std::uint64_t slice_bytes)
      : file_(std::move(file)), slice_bytes_(slice_bytes) {}

  std::span<std::byte> slice(std::int32_t k) {
    return file_->writable().subspan(static_cast<std::size_t>(k % kSlots) * slice_bytes_, slice_bytes_);
  }

 private:
  std::unique_ptr<MappedFile> file_;
  std::uint64_t slice_bytes_;
};

class SliceMover {
 public:
  SliceMover(const ByteSource& source, const RawLayout& layout, BrickWriter& writer, SliceRing ring, SampleTally& tally)
      : source_(source),
        layout_(layout),
        writer_(writer),
        ring_(std::move(ring)),
        tally_(tally),
        is_live_(static_cast<std::size_t>(layout.shape.inlines) * static_cast<std::size_t>(layout.shape.crosslines)) {}

  Result<std::string> move_all(Progress& progress) {
    const GridShape shape = layout_.shape;
    const std::int32_t layers = writer_.layout().grid().samples;
    Result<void> received;
    for (std::int32_t b = 0; b <= layers && received; ++b) {
      // The last slice of a layer is the first one of the next: both have it.
      const std::int32_t begin = b == 0 ? 0 : kBrickCells * b + 1;
      const std::int32_t end = b == layers ? 0 : std::min(kBrickCells * (b + 1) + 1, shape.samples);
      Result<void> turned;
      std::jthread turning;  // ends before what it writes to
      if (b > 0) turning = std::jthread([this, b, &turned] { turned = turn_layer(b - 1); });
      for (std::int32_t k = begin; k < end && received; ++k) {
        received = progress.cancelled() ? Error{ErrorCode::cancelled, "cancelled"} : receive(k);
        progress.report("import", static_cast<double>(k) / static_cast<double>(shape.samples));
      }
      if (turning.joinable()) turning.join();
      if (!turned) return std::move(turned).error();
    }
    if (!received) return std::move(received).error();
    describe_missing();
    return std::move(digest_).hex();
  }

 private:
  Result<void> receive(std::int32_t k) {
    const std::span<std::byte> slice = ring_.slice(k);
    for (std::uint64_t at = 0; at < slice.size(); at += kPieceBytes) {
      const auto piece = slice.subspan(at, std::min(kPieceBytes, slice.size() - at));
      if (auto read = source_.read_at(static_cast<std::uint64_t>(k) * slice.size() + at, piece); !read) return read;
      digest_.update(piece);
    }
    return {};
  }

  /// All bricks of a layer. One brick is read, turned, indexed and written while a processor's cache holds it.
  Result<void> turn_layer(std::int32_t b) {
    const GridShape grid = writer_.layout().grid();
    const std::size_t columns = static_cast<std::size_t>(grid.inlines) * static_cast<std::size_t>(grid.crosslines);
    std::vector<Result<void>> written(columns);
    parallel_for(columns, default_threads(), [&](std::size_t column) {
      const std::size_t brick = column * static_cast<std::size_t>(grid.samples) + static_cast<std::size_t>(b);
      written[column] = writer_.write_brick(brick, turn(writer_.layout().place(brick)));
      writer_.start_writing(brick, 1);
    });
    for (Result<void>& outcome : written)
      if (!outcome) return std::move(outcome);
    return {};
  }

  std::vector<float> turn(GridIndex place) {
    const GridIndex first = writer_.layout().first_node(place);
    const GridShape extent = writer_.layout().extent(place), own = own_nodes(place);
    const auto row = static_cast<std::size_t>(extent.inlines);
    std::vector<float> brick(static_cast<std::size_t>(extent.count()));
    std::vector<float> lines(row * static_cast<std::size_t>(extent.samples));  // of one crossline, 16 KiB
    for (std::int32_t j = 0; j < extent.crosslines; ++j) {
      for (std::int32_t k = 0; k < extent.samples; ++k) {
        const auto line = std::span(lines).subspan(row * static_cast<std::size_t>(k), row);
        const SampleCounts counts = read_line(first.i, first.j + j, first.k + k, line, own.inlines);
        if (j < own.crosslines && k < own.samples) tally_.add_infinite(counts.infinite);
      }
      for (std::int32_t i = 0; i < extent.inlines; ++i) {
        float* trace = brick.data() + (std::ptrdiff_t{i} * extent.crosslines + j) * extent.samples;
        const float* from = lines.data() + i;
        for (std::int32_t k = 0; k < extent.samples; ++k) trace[k] = from[std::ptrdiff_t{k} * extent.inlines];
        if (i < own.inlines && j < own.crosslines)
          count_missing(first.i + i, first.j + j, {trace, static_cast<std::size_t>(own.samples)});
      }
    }
    return brick;
  }

  /// Nodes of a brick without those that count for its next neighbours.
  GridShape own_nodes(GridIndex place) const {
    const GridShape grid = writer_.layout().grid();
    GridShape own = writer_.layout().extent(place);
    if (place.i + 1 < grid.inlines) own.inlines = kBrickCells;
    if (place.j + 1 < grid.crosslines) own.crosslines = kBrickCells;
    if (place.k + 1 < grid.samples) own.samples = kBrickCells;
    return own;
  }

  /// Samples of slice k at crossline j, from inline i on. returns: the counts of the first `own` ones.
  SampleCounts read_line(std::int32_t i, std::int32_t j, std::int32_t k, std::span<float> line, std::int32_t own) {
    const std::int64_t first = std::int64_t{j} * layout_.shape.inlines + i;
    const auto bytes =
        ring_.slice(k).subspan(layout_.bytes_of(first), layout_.bytes_of(static_cast<std::int64_t>(line.size())));
    decode_samples(layout_.code, layout_.big_endian, bytes, line);
    layout_.null.clean(line.subspan(static_cast<std::size_t>(own)));
    return layout_.null.clean(line.first(static_cast<std::size_t>(own)));
  }

  void count_missing(std::int32_t i, std::int32_t j, std::span<const float> samples) {
    std::int64_t missing = 0;
    for (const float value : samples) missing += value != value;
    if (missing < static_cast<std::int64_t>(samples.size())) is_live_[trace_of(i, j)] = 1;
    if (missing > 0) missing_ += missing;
  }

  std::size_t trace_of(std::int32_t i, std::int32_t j) const {
    return static_cast<std::size_t>(i) * static_cast<std::size_t>(layout_.shape.crosslines) +
           static_cast<std::size_t>(j);
  }

  void describe_missing() {
    const std::int64_t samples = layout_.shape.samples;
    const auto dead = static_cast<std::int64_t>(std::count(is_live_.begin(), is_live_.end(), std::uint8_t{0}));
    for (std::int64_t trace = 0; trace < dead; ++trace) tally_.add_trace(samples, samples);
    tally_.add_missing(missing_ - dead * samples);
  }

  const ByteSource& source_;
  const RawLayout& layout_;
  BrickWriter& writer_;
  SliceRing ring_;
  SampleTally& tally_;
  Sha256 digest_;
  std::vector<std::uint8_t> is_live_;  ///< traces with a valid sample
  std::atomic<std::int64_t> missing_{0};
};

}  // namespace

Result<std::string> move_slices(const ByteSource& source, const RawLayout& layout,
                                const std::optional<std::filesystem::path>& brick_file, BrickWriter& writer,
                                SampleTally& tally, Progress& progress) {
  const std::uint64_t slice_bytes = layout.bytes_of(std::int64_t{layout.shape.inlines} * layout.shape.crosslines);
  const auto slots = static_cast<std::uint64_t>(std::min(layout.shape.samples, kSlots));
  auto ring = brick_file ? MappedFile::create_unnamed(slots * slice_bytes, brick_file->parent_path())
                         : MappedFile::create_unnamed(slots * slice_bytes);
  if (!ring) return std::move(ring).error();
  return SliceMover(source, layout, writer, SliceRing(*std::move(ring), slice_bytes), tally).move_all(progress);
}

}  // namespace geosis
