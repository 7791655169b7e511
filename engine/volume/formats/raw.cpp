#include "engine/volume/formats/raw.h"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/volume/brick_layout.h"
#include "engine/volume/brick_writer.h"
#include "engine/volume/formats/raw_layout.h"
#include "engine/volume/formats/raw_slices.h"
#include "engine/volume/formats/record_stream.h"
#include "engine/volume/formats/sample_codec.h"
#include "engine/volume/formats/sample_tally.h"

namespace geosis {
namespace {

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

// Finishes the bricks of each layer of inlines as soon as its last inline is there.
class LayerFinisher {
 public:
  explicit LayerFinisher(BrickWriter& writer) : writer_(writer) {}

  void after(std::int64_t inlines) {
    const BrickLayout& layout = writer_.layout();
    const GridShape grid = layout.grid();
    while (next_ < grid.inlines &&
           layout.first_node({next_, 0, 0}).i + layout.extent({next_, 0, 0}).inlines <= inlines) {
      const std::size_t bricks = static_cast<std::size_t>(grid.crosslines) * static_cast<std::size_t>(grid.samples);
      const std::size_t first = static_cast<std::size_t>(next_) * bricks;
      parallel_for(bricks, default_threads(), [&](std::size_t brick) { writer_.complete(first + brick); });
      writer_.start_writing(first, bricks);
      ++next_;
    }
  }

 private:
  BrickWriter& writer_;
  std::int32_t next_ = 0;
};

// Sample fastest: the file is trace after trace. Returns the digest.
Result<std::string> move_traces(const ByteSource& source, const RawLayout& layout, BrickWriter& writer,
                                SampleTally& tally, Progress& progress) {
  const std::uint64_t trace_bytes = layout.bytes_of(layout.shape.samples);
  const auto crosslines = static_cast<std::uint64_t>(layout.shape.crosslines);
  LayerFinisher finisher(writer);
  const RecordVisitor visitor{
      .in_order = [](const RecordBatch&) {},
      .at_once =
          [&](const RecordBatch& batch) {
            std::vector<float> samples(static_cast<std::size_t>(layout.shape.samples));
            for (std::uint64_t t = 0; t < batch.count; ++t)
              put_trace(layout, static_cast<std::int64_t>(batch.first + t),
                        batch.bytes.subspan(t * trace_bytes, trace_bytes), samples, writer, tally);
          },
      .after = [&](std::uint64_t traces) { finisher.after(static_cast<std::int64_t>(traces / crosslines)); }};
  const auto traces = static_cast<std::uint64_t>(layout.shape.inlines) * crosslines;
  return stream_records(source, {0, trace_bytes, traces}, visitor, default_threads(), progress);
}

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

std::optional<std::uint64_t> raw_file_bytes(const ImportOptions& options) {
  const bool is_raw =
      options.format == FileFormat::raw || (options.format == FileFormat::automatic && options.dims.has_value());
  if (!is_raw || !options.dims || !check_axes(*options.dims)) return std::nullopt;
  // Each axis is below 2^17, so that the product of all and 8 bytes is below 2^54.
  return static_cast<std::uint64_t>(options.dims->count()) * bytes_per_sample(code_of(options.dtype));
}

Result<ImportedVolume> import_raw(const ByteSource& source, const ImportOptions& options,
                                  const std::optional<std::filesystem::path>& brick_file, Progress& progress) {
  const auto layout = read_layout(source, options);
  if (!layout) return layout.error();
  auto writer = BrickWriter::create(layout->shape, brick_file);
  if (!writer) return std::move(writer).error();

  SampleTally tally;
  auto digest = options.order == RawOrder::sample_fastest
                    ? move_traces(source, *layout, *writer, tally, progress)
                    : move_slices(source, *layout, brick_file, *writer, tally, progress);
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
