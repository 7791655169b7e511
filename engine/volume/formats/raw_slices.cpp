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
constexpr std::int64_t kTileSamples = 1 << 19;  // 2 MiB: stays in a processor's cache
constexpr std::int32_t kLongestRow = 4096;
constexpr std::int32_t kSlots = 2 * kBrickSamples;  // one layer of bricks is turned while the next arrives

/// Some inlines of some crosslines, all slices of a layer of bricks.
struct Tile {
  std::int32_t i0 = 0, inlines = 0, j0 = 0, crosslines = 0;
};

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
      std::jthread turning;
      if (b > 0) turning = std::jthread([this, b] { turn_layer(b - 1); });
      for (std::int32_t k = begin; k < end && received; ++k) {
        received = progress.cancelled() ? Error{ErrorCode::cancelled, "cancelled"} : receive(k);
        progress.report("import", static_cast<double>(k) / static_cast<double>(shape.samples));
      }
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

  /// All tiles of a layer of bricks, then their index.
  void turn_layer(std::int32_t b) {
    const GridShape grid = writer_.layout().grid();
    const std::vector<Tile> tiles = tiles_of_layer();
    parallel_for(tiles.size(), default_threads(), [&](std::size_t t) { turn(b, tiles[t]); });
    const std::size_t columns = static_cast<std::size_t>(grid.inlines) * static_cast<std::size_t>(grid.crosslines);
    const auto samples = static_cast<std::size_t>(grid.samples);
    parallel_for(columns, default_threads(), [&](std::size_t column) {
      const std::size_t brick = column * samples + static_cast<std::size_t>(b);
      writer_.complete(brick);
      writer_.start_writing(brick, 1);
    });
  }

  std::vector<Tile> tiles_of_layer() const {
    const GridShape shape = layout_.shape;
    const std::int32_t inlines = std::min(shape.inlines, kLongestRow);
    const auto crosslines = static_cast<std::int32_t>(
        std::clamp<std::int64_t>(kTileSamples / (std::int64_t{kBrickSamples} * inlines), 1, shape.crosslines));
    std::vector<Tile> tiles;
    for (std::int32_t j = 0; j < shape.crosslines; j += crosslines)
      for (std::int32_t i = 0; i < shape.inlines; i += inlines)
        tiles.push_back({i, std::min(inlines, shape.inlines - i), j, std::min(crosslines, shape.crosslines - j)});
    return tiles;
  }

  void turn(std::int32_t b, const Tile& tile) {
    const GridShape shape = layout_.shape;
    const std::int32_t k0 = kBrickCells * b, count = std::min(kBrickSamples, shape.samples - k0);
    const bool is_last = k0 + count == shape.samples;
    const std::int32_t own = is_last ? count : count - 1;  // the shared slice counts for the next layer
    const std::size_t row = static_cast<std::size_t>(tile.inlines);
    std::vector<float> samples(row * static_cast<std::size_t>(tile.crosslines) * static_cast<std::size_t>(count));
    for (std::int32_t k = 0; k < count; ++k) {
      for (std::int32_t j = 0; j < tile.crosslines; ++j) {
        const std::int64_t first = std::int64_t{tile.j0 + j} * shape.inlines + tile.i0;
        const auto bytes = ring_.slice(k0 + k).subspan(layout_.bytes_of(first), layout_.bytes_of(tile.inlines));
        const auto line = std::span(samples).subspan(row * static_cast<std::size_t>(k * tile.crosslines + j), row);
        decode_samples(layout_.code, layout_.big_endian, bytes, line);
        const SampleCounts counts = layout_.null.clean(line);
        if (k < own) tally_.add_infinite(counts.infinite);
      }
    }
    for (std::int32_t j = 0; j < tile.crosslines; ++j) put_crossline(b, tile, j, samples, count, own);
  }

  /// Gathers the part of every trace of one crossline and writes it.
  void put_crossline(std::int32_t b, const Tile& tile, std::int32_t j, std::span<const float> samples,
                     std::int32_t count, std::int32_t own) {
    const std::int64_t slab = std::int64_t{tile.inlines} * tile.crosslines;
    std::int64_t missing = 0;
    std::vector<float> part(static_cast<std::size_t>(count));
    for (std::int32_t i = 0; i < tile.inlines; ++i) {
      const float* from = samples.data() + std::int64_t{j} * tile.inlines + i;
      std::int32_t missing_here = 0;
      for (std::int32_t k = 0; k < count; ++k) {
        const float value = from[k * slab];
        part[static_cast<std::size_t>(k)] = value;
        missing_here += k < own && value != value;
      }
      missing += missing_here;
      if (missing_here < own) is_live_[trace_of(tile.i0 + i, tile.j0 + j)] = 1;
      writer_.put_in_layer(b, tile.i0 + i, tile.j0 + j, kBrickCells * b, part);
    }
    missing_ += missing;
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
