#include "engine/volume/formats/raw.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/volume/brick_layout.h"
#include "engine/volume/brick_writer.h"
#include "engine/volume/formats/record_stream.h"
#include "engine/volume/formats/sample_codec.h"
#include "engine/volume/formats/sample_tally.h"

namespace geosis {
namespace {

constexpr std::uint64_t kTileBytes = 8 << 20;

struct RawLayout {
  GridShape shape;
  SampleCode code = SampleCode::ieee32;
  bool big_endian = false;
  NullValue null;

  std::uint64_t bytes_of(std::int64_t samples) const {
    return static_cast<std::uint64_t>(samples) * bytes_per_sample(code);
  }
};

SampleCode code_of(SampleType type) {
  switch (type) {
    case SampleType::float32:
      return SampleCode::ieee32;
    case SampleType::float64:
      return SampleCode::ieee64;
    case SampleType::int8:
      return SampleCode::int8;
    case SampleType::uint8:
      return SampleCode::uint8;
    case SampleType::int16:
      return SampleCode::int16;
    case SampleType::uint16:
      return SampleCode::uint16;
    case SampleType::int32:
      return SampleCode::int32;
    case SampleType::uint32:
      return SampleCode::uint32;
  }
  return SampleCode::ieee32;
}

bool is_usable(Vec3d v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

Result<void> check_geometry(const ImportOptions& options) {
  if (!is_usable(options.origin)) return Error{ErrorCode::invalid_argument, "raw: origin is not finite"};
  const Vec3d s = options.spacing;
  if (!is_usable(s) || s.x == 0 || s.y == 0 || s.z == 0)
    return Error{ErrorCode::invalid_argument, "raw: spacing " + std::to_string(s.x) + ", " + std::to_string(s.y) +
                                                  ", " + std::to_string(s.z) + "; expected finite and not 0"};
  return {};
}

Result<RawLayout> read_layout(const ByteSource& source, const ImportOptions& options) {
  if (!options.dims) return Error{ErrorCode::invalid_argument, "raw: dims (inlines, crosslines, samples) is required"};
  const GridShape shape = *options.dims;
  if (auto valid = check_axes(shape); !valid) return std::move(valid).error();
  const std::string dims =
      std::to_string(shape.inlines) + " x " + std::to_string(shape.crosslines) + " x " + std::to_string(shape.samples);
  if (shape.inlines < 2 || shape.crosslines < 2 || shape.samples < 2)
    return Error{ErrorCode::invalid_argument, "raw: dims " + dims + "; expected at least 2 on each axis"};
  if (auto valid = check_geometry(options); !valid) return std::move(valid).error();

  const SampleCode code = code_of(options.dtype);
  const RawLayout layout{shape, code, options.byte_order == ByteOrder::big, NullValue(options.null_value, code)};
  // Each axis is below 2^17, so that the product of all and 8 bytes is below 2^54.
  if (const std::uint64_t expected = layout.bytes_of(shape.count()); expected != source.size())
    return Error{ErrorCode::malformed_input, "raw: " + std::to_string(source.size()) + " bytes; expected " +
                                                 std::to_string(expected) + " for " + dims + " samples of " +
                                                 std::to_string(bytes_per_sample(code)) + " bytes"};
  return layout;
}

void put_trace(const RawLayout& layout, std::int64_t trace, std::span<const std::byte> bytes, std::span<float> samples,
               BrickWriter& writer, SampleTally& tally) {
  decode_samples(layout.code, layout.big_endian, bytes, samples);
  const SampleCounts counts = layout.null.clean(samples);
  tally.add_infinite(counts.infinite);
  tally.add_trace(layout.shape.samples, counts.missing);
  writer.put(static_cast<std::int32_t>(trace / layout.shape.crosslines),
             static_cast<std::int32_t>(trace % layout.shape.crosslines), 0, samples);
}

// Sample fastest: the file is trace after trace. Returns the digest.
Result<std::string> move_traces(const ByteSource& source, const RawLayout& layout, BrickWriter& writer,
                                SampleTally& tally, Progress& progress) {
  const std::uint64_t trace_bytes = layout.bytes_of(layout.shape.samples);
  const auto traces =
      static_cast<std::uint64_t>(layout.shape.inlines) * static_cast<std::uint64_t>(layout.shape.crosslines);
  const RecordVisitor visitor{[](const RecordBatch&) {},
                              [&](const RecordBatch& batch) {
                                std::vector<float> samples(static_cast<std::size_t>(layout.shape.samples));
                                for (std::uint64_t t = 0; t < batch.count; ++t)
                                  put_trace(layout, static_cast<std::int64_t>(batch.first + t),
                                            batch.bytes.subspan(t * trace_bytes, trace_bytes), samples, writer, tally);
                              }};
  return stream_records(source, {0, trace_bytes, traces}, visitor, default_threads(), progress);
}

/// Part of a file whose inline index is fastest: all inlines of some crosslines of some samples.
struct Tile {
  std::int32_t j0 = 0, crosslines = 0, k0 = 0, samples = 0;
};

/// Turns a file whose inline index is fastest, tile by tile.
class TileMover {
 public:
  TileMover(const ByteSource& source, const RawLayout& layout, BrickWriter& writer)
      : source_(source),
        layout_(layout),
        writer_(writer),
        missing_in_trace_(static_cast<std::size_t>(layout.shape.inlines) *
                          static_cast<std::size_t>(layout.shape.crosslines)) {}

  Result<void> move_all(SampleTally& tally, Progress& progress) {
    const GridShape& shape = layout_.shape;
    const Tile whole = tile_size();
    for (std::int32_t k = 0; k < shape.samples; k += whole.samples) {
      for (std::int32_t j = 0; j < shape.crosslines; j += whole.crosslines) {
        if (progress.cancelled()) return Error{ErrorCode::cancelled, "cancelled"};
        const Tile tile{j, std::min(whole.crosslines, shape.crosslines - j), k,
                        std::min(whole.samples, shape.samples - k)};
        if (auto moved = move(tile, tally); !moved) return moved;
      }
      progress.report("import", static_cast<double>(k) / static_cast<double>(shape.samples));
    }
    for (const std::int32_t missing : missing_in_trace_) tally.add_trace(shape.samples, missing);
    return {};
  }

 private:
  // As many samples as a brick has, as many crosslines as fit: long reads, and whole rows of bricks to write.
  Tile tile_size() const {
    const std::uint64_t line = layout_.bytes_of(layout_.shape.inlines);
    const auto lines = static_cast<std::int32_t>(std::clamp<std::uint64_t>(kTileBytes / line, 1, 1u << 30));
    const std::int32_t samples = std::min({kBrickCells, layout_.shape.samples, lines});
    return {0, std::clamp(lines / samples, 1, layout_.shape.crosslines), 0, samples};
  }

  Result<void> move(const Tile& tile, SampleTally& tally) {
    const std::int64_t slab = std::int64_t{layout_.shape.inlines} * tile.crosslines;
    bytes_.resize(layout_.bytes_of(slab * tile.samples));
    for (std::int32_t k = 0; k < tile.samples; ++k) {
      const std::int64_t first =
          (std::int64_t{tile.k0 + k} * layout_.shape.crosslines + tile.j0) * layout_.shape.inlines;
      const auto into = std::span(bytes_).subspan(layout_.bytes_of(slab * k), layout_.bytes_of(slab));
      if (auto read = source_.read_at(layout_.bytes_of(first), into); !read) return read;
    }
    samples_.resize(static_cast<std::size_t>(slab) * static_cast<std::size_t>(tile.samples));
    decode_samples(layout_.code, layout_.big_endian, bytes_, samples_);
    tally.add_infinite(layout_.null.clean(samples_).infinite);
    parallel_for(static_cast<std::size_t>(tile.crosslines), default_threads(),
                 [&](std::size_t j) { put_crossline(tile, static_cast<std::int32_t>(j)); });
    return {};
  }

  // Gathers the part of every trace of one crossline and writes it.
  void put_crossline(const Tile& tile, std::int32_t j) {
    const std::int64_t slab = std::int64_t{layout_.shape.inlines} * tile.crosslines;
    std::vector<float> part(static_cast<std::size_t>(tile.samples));
    for (std::int32_t i = 0; i < layout_.shape.inlines; ++i) {
      const float* from = samples_.data() + std::int64_t{j} * layout_.shape.inlines + i;
      std::int32_t missing = 0;
      for (std::size_t k = 0; k < part.size(); ++k) {
        part[k] = from[static_cast<std::int64_t>(k) * slab];
        missing += part[k] != part[k];
      }
      missing_in_trace_[static_cast<std::size_t>(i) * static_cast<std::size_t>(layout_.shape.crosslines) +
                        static_cast<std::size_t>(tile.j0 + j)] += missing;
      writer_.put(i, tile.j0 + j, tile.k0, part);
    }
  }

  const ByteSource& source_;
  const RawLayout& layout_;
  BrickWriter& writer_;
  std::vector<std::byte> bytes_;
  std::vector<float> samples_;
  std::vector<std::int32_t> missing_in_trace_;
};

VolumeDescription describe_raw(const RawLayout& layout, const ImportOptions& options) {
  VolumeDescription d;
  d.shape = layout.shape;
  d.format = "raw";
  d.options = options;
  d.options.format = FileFormat::raw;
  d.options.byte_order = layout.big_endian ? ByteOrder::big : ByteOrder::little;
  d.inline_axis = {0, 1, 0};
  d.crossline_axis = {0, 1, 0};
  d.sample_axis = {options.origin.z, options.spacing.z, 0};
  const Vec3d step = options.spacing;
  d.geometry = AffineGeometry(options.origin, {step.x, 0, 0}, {0, step.y, 0}, {0, 0, step.z});
  return d;
}

}  // namespace

Result<ImportedVolume> import_raw(const ByteSource& source, const ImportOptions& options,
                                  const std::optional<std::filesystem::path>& brick_file, Progress& progress) {
  const auto layout = read_layout(source, options);
  if (!layout) return layout.error();
  auto writer = BrickWriter::create(layout->shape, brick_file);
  if (!writer) return std::move(writer).error();

  SampleTally tally;
  Result<std::string> digest = std::string();
  if (options.order == RawOrder::sample_fastest) {
    digest = move_traces(source, *layout, *writer, tally, progress);
  } else {
    if (auto moved = TileMover(source, *layout, *writer).move_all(tally, progress); !moved)
      return std::move(moved).error();
    digest = digest_of(source, progress);
  }
  if (!digest) return std::move(digest).error();
  auto samples = std::move(*writer).finish(default_threads(), progress);
  if (!samples) return std::move(samples).error();

  ImportedVolume volume{*std::move(samples), describe_raw(*layout, options)};
  tally.describe(*volume.samples, volume.description);
  volume.description.bytes = static_cast<std::int64_t>(source.size());
  volume.description.digest = *std::move(digest);
  return volume;
}

}  // namespace geosis
