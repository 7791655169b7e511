#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/volume/bricks.h"
#include "engine/volume/formats/byte_source.h"
#include "engine/volume/geometry.h"
#include "engine/volume/grid.h"

namespace geosis {

enum class FileFormat { automatic, segy, raw };
enum class ByteOrder { automatic, little, big };
enum class SampleType { float32, float64, int8, uint8, int16, uint16, int32, uint32 };
enum class RawOrder { sample_fastest, inline_fastest };
enum class DuplicateTraces { reject, first, last, mean };
enum class ZeroTraces { keep, missing };

/// How to read a file: the import options of the outside contract. Unset means: found from the file.
struct ImportOptions {
  FileFormat format = FileFormat::automatic;
  ByteOrder byte_order = ByteOrder::automatic;  ///< raw: automatic = little
  std::optional<double> null_value{};           ///< samples of this value are missing

  // raw
  std::optional<GridShape> dims{};
  SampleType dtype = SampleType::float32;
  RawOrder order = RawOrder::sample_fastest;
  Vec3d origin{0, 0, 0};
  Vec3d spacing{1, 1, 1};

  // segy; header positions are 1-based, counted from the start of the trace header
  std::optional<int> inline_byte{}, crossline_byte{}, x_byte{}, y_byte{};
  int inline_width = 4, crossline_width = 4;  ///< bytes, 2 or 4
  std::optional<double> coordinate_scalar{};  ///< in place of the one in byte 71: positive multiplies, negative divides
  std::optional<int> sample_format{};         ///< overrides the binary header's code
  DuplicateTraces duplicates = DuplicateTraces::reject;
  ZeroTraces zero_traces = ZeroTraces::keep;
};

struct Axis {
  double first = 0, step = 1;  ///< survey numbers (inline, crossline) or ms / m (sample)
  int byte = 0;                ///< trace header byte it was read from; 0 when it was not
};

struct Warning {
  std::string code, detail;
};

/// Everything about a volume that is not a sample: what the volume document says.
struct VolumeDescription {
  GridShape shape;
  Axis inline_axis, crossline_axis, sample_axis;
  std::string sample_unit;  ///< "ms", "m" or ""
  AffineGeometry geometry;
  std::string geometry_unit;  ///< of x and y: "m", "ft" or ""
  ValueRange value_range;
  std::int64_t missing_samples = 0, missing_traces = 0;
  std::int64_t bytes = 0;  ///< of the file
  std::string format;      ///< "segy" or "raw"
  std::string digest;      ///< sha-256 of the file's bytes, hexadecimal
  ImportOptions options;   ///< with what was found filled in
  std::string text_header;
  std::vector<Warning> warnings;
};

/// A pair of header bytes under which the traces would make a grid.
struct GridCandidate {
  int inline_byte = 0, crossline_byte = 0;
  GridShape shape;
  std::int64_t missing_traces = 0;
};

struct ImportedVolume {
  std::unique_ptr<BrickedVolume> samples;
  VolumeDescription description;
};

/// Bytes of a raw file with these options; nullopt: not a raw file, or not known, as dims are missing or make no sense.
std::optional<std::uint64_t> raw_file_bytes(const ImportOptions& options);

/// Reads a survey into a brick file and opens it.
///
/// source       read in place, piece by piece; memory stays flat whatever its size. A raw file (raw_file_bytes) is read
///              once, in order, by the calling thread alone: it may still arrive.
/// brick_file   where the brick file goes; std::nullopt = an unnamed temporary file that vanishes with the volume.
///              A failed import leaves nothing behind.
/// missing      a position of the survey without any valid sample counts as a missing trace. Infinite samples, and
///              samples beyond float32, become missing.
/// warnings     codes are stable: dead_traces, delay, duplicate_traces, extended_text_count, infinite_samples,
///              no_coordinates, no_valid_samples, sample_count, sample_interval, trace_sample_count.
///
/// candidates   when not null: filled with the grids found when the header bytes are ambiguous or absent.
/// errors       malformed_input, unsupported (2D line, prestack, ...), invalid_argument (options), limit_exceeded,
///              no_space, unavailable, cancelled.
Result<ImportedVolume> import_volume(const ByteSource& source, const ImportOptions& options,
                                     const std::optional<std::filesystem::path>& brick_file, Progress& progress,
                                     std::vector<GridCandidate>* candidates = nullptr);

}  // namespace geosis
