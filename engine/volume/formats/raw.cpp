#include "engine/volume/formats/raw.h"

#include <algorithm>
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
#include "engine/volume/trace_order_writer.h"

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

// Sample fastest: the file is trace after trace. Each column of bricks takes its traces of a batch.
class RawTraces {
 public:
  RawTraces(const RawLayout& layout, BrickWriter& writer, SampleTally& tally)
      : layout_(layout), writer_(writer), tally_(tally) {}

  std::size_t columns() const { return static_cast<std::size_t>(writer_.columns()); }

  Result<void> move(const RecordBatch& batch, std::int32_t column) {
    const std::int64_t crosslines = layout_.shape.crosslines;
    const std::int32_t begin = writer_.first_crossline(column), end = begin + writer_.crosslines(column);
    const auto first = static_cast<std::int64_t>(batch.first), last = first + static_cast<std::int64_t>(batch.count);
    Run run;
    for (std::int64_t i = first / crosslines; i * crosslines < last; ++i) {
      const std::int64_t stop = std::min(last, i * crosslines + end);
      for (std::int64_t trace = std::max(first, i * crosslines + begin); trace < stop; ++trace) {
        if (run.traces.empty()) run.first = trace;
        add(batch, trace, column, run);
        if (std::ssize(run.traces) * layout_.shape.samples < kSamplesAtOnce) continue;
        if (auto put = put_run(column, run); !put) return put;
      }
    }
    return run.traces.empty() ? Result<void>{} : put_run(column, run);
  }

 private:
  static constexpr std::int64_t kSamplesAtOnce = 1 << 20;  // 4 MiB

  /// Traces of one column that follow each other.
  struct Run {
    std::int64_t first = 0;
    std::vector<const float*> traces;  ///< in the batch where it holds them as they are, else in `decoded`
    std::vector<float> decoded;        ///< never grows beyond what was reserved
  };

  Result<void> put_run(std::int32_t column, Run& run) {
    const std::int64_t crosslines = layout_.shape.crosslines;
    auto put = writer_.put(column, static_cast<std::int32_t>(run.first / crosslines),
                           static_cast<std::int32_t>(run.first % crosslines), run.traces);
    run.traces.clear();
    run.decoded.clear();
    return put;
  }

  void add(const RecordBatch& batch, std::int64_t trace, std::int32_t column, Run& run) {
    const std::uint64_t bytes = layout_.bytes_of(layout_.shape.samples);
    const auto stored = batch.bytes.subspan((static_cast<std::uint64_t>(trace) - batch.first) * bytes, bytes);
    SampleCounts counts;
    if (const float* plain = plain_samples(stored)) {
      run.traces.push_back(plain);
    } else {
      const std::span<float> line = room_for_trace(run.decoded);
      decode_samples(layout_.code, layout_.big_endian, stored, line);
      counts = layout_.null.clean(line);
      run.traces.push_back(line.data());
    }
    // The last crossline of a column counts for the next one.
    const bool is_own =
        column + 1 == writer_.columns() || trace % layout_.shape.crosslines < writer_.first_crossline(column + 1);
    if (!is_own) return;
    tally_.add_infinite(counts.infinite);
    tally_.add_trace(layout_.shape.samples, counts.missing);
  }

  /// The trace itself, if it is stored as we hold it and nothing in it is missing; else null.
  const float* plain_samples(std::span<const std::byte> stored) const {
    if (layout_.code != SampleCode::ieee32 || layout_.big_endian) return nullptr;
    if (reinterpret_cast<std::uintptr_t>(stored.data()) % alignof(float) != 0) return nullptr;
    const auto* samples = reinterpret_cast<const float*>(stored.data());
    return layout_.null.keeps({samples, stored.size() / sizeof(float)}) ? samples : nullptr;
  }

  std::span<float> room_for_trace(std::vector<float>& decoded) const {
    const auto length = static_cast<std::size_t>(layout_.shape.samples);
    if (decoded.empty()) decoded.reserve(static_cast<std::size_t>(kSamplesAtOnce) + length);
    decoded.resize(decoded.size() + length);
    return std::span(decoded).last(length);
  }

  const RawLayout& layout_;
  TraceOrderWriter writer_;
  SampleTally& tally_;
};

// Returns the digest.
Result<std::string> move_traces(const ByteSource& source, const RawLayout& layout, BrickWriter& writer,
                                SampleTally& tally, Progress& progress) {
  RawTraces traces(layout, writer, tally);
  RecordVisitor visitor;
  visitor.parts = traces.columns();
  visitor.in_parts = [&](const RecordBatch& batch, std::size_t column) {
    return traces.move(batch, static_cast<std::int32_t>(column));
  };
  const auto count =
      static_cast<std::uint64_t>(layout.shape.inlines) * static_cast<std::uint64_t>(layout.shape.crosslines);
  return stream_records(source, {0, layout.bytes_of(layout.shape.samples), count}, visitor, default_threads(),
                        progress);
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
