#include "server/documents/volume_document.h"

#include <cmath>

#include "server/documents/ids.h"
#include "server/documents/import_options.h"

namespace geosis::server {
namespace {

Json dims_document(GridShape shape) {
  return {shape.inlines, shape.crosslines, shape.samples};
}

Json trace_axis_document(const Axis& axis) {
  return {{"first", number_or_null(axis.first)},
          {"step", number_or_null(axis.step)},
          {"byte", axis.byte > 0 ? Json(axis.byte) : Json(nullptr)}};
}

Json axes_document(const VolumeDescription& volume) {
  return {{"inline", trace_axis_document(volume.inline_axis)},
          {"crossline", trace_axis_document(volume.crossline_axis)},
          {"sample",
           {{"first", number_or_null(volume.sample_axis.first)},
            {"step", number_or_null(volume.sample_axis.step)},
            {"unit", volume.sample_unit}}}};
}

Json warnings_document(const std::vector<Warning>& warnings) {
  Json list = Json::array();
  for (const auto& warning : warnings) list.push_back({{"code", warning.code}, {"detail", warning.detail}});
  return list;
}

}  // namespace

Json volume_document(const VolumeDescription& volume, const std::string& name) {
  return {{"id", volume_id(volume)},
          {"name", name},
          {"text_header", volume.text_header},
          {"dims", dims_document(volume.shape)},
          {"axes", axes_document(volume)},
          {"geometry", {{"transform", *volume.geometry.affine()}, {"unit", volume.geometry_unit}}},
          {"value_range", {number_or_null(volume.value_range.min), number_or_null(volume.value_range.max)}},
          {"missing", {{"samples", volume.missing_samples}, {"traces", volume.missing_traces}}},
          {"bytes", volume.bytes},
          {"format", volume.format},
          {"options", import_options_document(volume.options)},
          {"warnings", warnings_document(volume.warnings)}};
}

AffineGeometry geometry_of(const std::array<double, 16>& transform) {
  const auto& m = transform;
  return AffineGeometry({m[3], m[7], m[11]}, {m[0], m[4], m[8]}, {m[1], m[5], m[9]}, {m[2], m[6], m[10]});
}

VolumeSummary summarize(const VolumeDescription& volume) {
  return {volume_id(volume), volume.shape, volume.geometry, volume.sample_unit};
}

Result<VolumeSummary> parse_volume_document(const Json& document) {
  try {
    const Json& dims = document.at("dims");
    return VolumeSummary{
        .id = document.at("id").get<std::string>(),
        .shape = {dims.at(0).get<std::int32_t>(), dims.at(1).get<std::int32_t>(), dims.at(2).get<std::int32_t>()},
        .geometry = geometry_of(document.at("geometry").at("transform").get<std::array<double, 16>>()),
        .sample_unit = document.at("axes").at("sample").at("unit").get<std::string>()};
  } catch (const Json::exception& problem) {
    return Error{ErrorCode::malformed_input, std::string("volume document: ") + problem.what()};
  }
}

std::optional<std::int32_t> node_called(const Json& document, int axis, double number) {
  static constexpr std::array kNames = {"inline", "crossline", "sample"};
  const Json& numbers = document.at("axes").at(kNames[static_cast<std::size_t>(axis)]);
  if (!numbers.at("first").is_number() || !numbers.at("step").is_number()) return std::nullopt;
  const double first = numbers.at("first").get<double>(), step = numbers.at("step").get<double>();
  const std::int32_t nodes = document.at("dims").at(static_cast<std::size_t>(axis)).get<std::int32_t>();
  const double node = std::round((number - first) / step);
  if (!(node >= 0 && node < nodes) || first + node * step != number) return std::nullopt;
  return static_cast<std::int32_t>(node);
}

Json candidates_document(const std::vector<GridCandidate>& candidates) {
  Json list = Json::array();
  for (const auto& candidate : candidates) {
    list.push_back({{"inline_byte", candidate.inline_byte},
                    {"crossline_byte", candidate.crossline_byte},
                    {"dims", dims_document(candidate.shape)},
                    {"missing_traces", candidate.missing_traces}});
  }
  return list;
}

}  // namespace geosis::server
