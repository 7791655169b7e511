#include "engine/volume/formats/segy_describe.h"

#include <cmath>
#include <string>

#include "engine/volume/formats/grid_words.h"

namespace geosis {
namespace {

// Delay recording time in ms, with the scalar for times that revision 1 added.
double delay_ms(const HeaderView& header, int revision) {
  const auto delay = static_cast<double>(header.at<std::int16_t>(109));
  const auto scalar = revision >= 1 ? header.at<std::int16_t>(215) : std::int16_t{0};
  if (scalar == 0) return delay;
  return scalar > 0 ? delay * scalar : delay / -static_cast<double>(scalar);
}

// Sample interval in ms: the binary header's, else the first trace header's.
Axis sample_axis(const SegyLayout& layout, const HeaderView& first_trace, VolumeDescription& description) {
  double interval_us = layout.interval_us;
  if (!(interval_us > 0)) {
    interval_us = first_trace.at<std::uint16_t>(117);
    const std::string wrong = "sample interval " + std::to_string(layout.interval_us) + " us at byte 3217";
    if (interval_us > 0)
      description.warnings.push_back(
          {"sample_interval", wrong + "; taken from the trace headers: " + std::to_string(interval_us) + " us"});
    else
      description.warnings.push_back({"sample_interval", wrong + " and none in the trace headers; taken as 1 ms"});
  }
  return {delay_ms(first_trace, layout.revision), interval_us > 0 ? interval_us / 1000 : 1, 0};
}

Axis survey_axis(const GridNumbers& numbers) {
  return {static_cast<double>(numbers.first), static_cast<double>(numbers.step), numbers.word.byte};
}

// The options that give this volume again, whatever this program learns to find by itself later.
ImportOptions canonical(const SegyLayout& layout, const TraceGrid& grid, ImportOptions options) {
  options.format = FileFormat::segy;
  options.byte_order = layout.big_endian ? ByteOrder::big : ByteOrder::little;
  options.sample_format = layout.format_code;
  options.inline_byte = grid.inlines.word.byte;
  options.inline_width = grid.inlines.word.width;
  options.crossline_byte = grid.crosslines.word.byte;
  options.crossline_width = grid.crosslines.word.width;
  return options;
}

void set_survey_number_geometry(VolumeDescription& d) {
  d.geometry = AffineGeometry({d.inline_axis.first, d.crossline_axis.first, d.sample_axis.first},
                              {d.inline_axis.step, 0, 0}, {0, d.crossline_axis.step, 0}, {0, 0, d.sample_axis.step});
}

void set_geometry(std::span<const CoordinateWords> coordinates, const std::string& length_unit, VolumeDescription& d) {
  std::string why;
  for (const CoordinateWords& words : coordinates) {
    const auto plane = words.solve();
    if (!plane) {
      why += (why.empty() ? "" : "; ") + plane.error().message;
      continue;
    }
    const Vec3d origin{plane->origin.x, plane->origin.y, d.sample_axis.first};
    d.geometry = AffineGeometry(origin, plane->step_i, plane->step_j, {0, 0, d.sample_axis.step});
    d.geometry_unit = length_unit;
    d.options.x_byte = words.x().byte;
    d.options.y_byte = words.y().byte;
    return;
  }
  set_survey_number_geometry(d);
  d.warnings.push_back({"no_coordinates", why + "; x and y are the inline and crossline numbers"});
}

void warn_about_headers(const SegyLayout& layout, const TraceScan& scan, VolumeDescription& d) {
  const bool says_other = scan.samples.max() != 0 && (scan.samples.varies() || scan.samples.max() != layout.samples);
  if (says_other)
    d.warnings.push_back({"trace_sample_count", describe("trace headers say samples", {115, 2}, scan.samples) +
                                                    "; the file has " + std::to_string(layout.samples) + " a trace"});
  if (scan.delay.varies())
    d.warnings.push_back({"delay", describe("delay recording times in ms", {109, 2}, scan.delay) +
                                       "; all traces are placed at the first one's"});
}

Result<void> check_byte(const char* name, std::optional<int> byte) {
  constexpr int last = static_cast<int>(kTraceHeaderBytes) - 3;
  if (!byte || (*byte >= 1 && *byte <= last)) return {};
  return Error{ErrorCode::invalid_argument,
               std::string(name) + " " + std::to_string(*byte) + "; expected 1.." + std::to_string(last)};
}

}  // namespace

Result<std::vector<CoordinateWords>> coordinates_to_try(const ImportOptions& options) {
  if (auto valid = check_byte("x_byte", options.x_byte); !valid) return std::move(valid).error();
  if (auto valid = check_byte("y_byte", options.y_byte); !valid) return std::move(valid).error();
  const auto& scalar = options.coordinate_scalar;
  if (scalar && (!std::isfinite(*scalar) || *scalar == 0))
    return Error{ErrorCode::invalid_argument, "coordinate_scalar " + std::to_string(*scalar)};
  if (options.x_byte || options.y_byte)
    return std::vector<CoordinateWords>{{{options.x_byte.value_or(181)}, {options.y_byte.value_or(185)}, scalar}};
  return std::vector<CoordinateWords>{{{181}, {185}, scalar}, {{73}, {77}, scalar}};
}

VolumeDescription describe_segy(const SegyLayout& layout, const FoundGrid& found, const ImportOptions& options,
                                std::span<const CoordinateWords> coordinates) {
  const TraceGrid& grid = found.grid;
  VolumeDescription d;
  d.format = "segy";
  d.text_header = layout.text;
  d.warnings = layout.warnings;
  d.options = canonical(layout, grid, options);
  d.shape = {grid.inlines.count, grid.crosslines.count, layout.samples};
  d.inline_axis = survey_axis(grid.inlines);
  d.crossline_axis = survey_axis(grid.crosslines);
  d.sample_axis = sample_axis(layout, trace_header_view(found.scan.first_header, layout), d);
  d.sample_unit = "ms";
  set_geometry(coordinates, layout.length_unit, d);
  warn_about_headers(layout, found.scan, d);
  return d;
}

}  // namespace geosis
