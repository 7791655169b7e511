#include "server/documents/request.h"

#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "engine/pipeline/preview.h"
#include "server/documents/grid_report.h"
#include "server/documents/ids.h"
#include "server/documents/object_reader.h"
#include "server/documents/request_levels.h"
#include "server/documents/request_sections.h"

namespace geosis::server {
namespace {

constexpr std::int64_t kLastNode = std::numeric_limits<std::int32_t>::max() - 1;
constexpr double kFastest = 20'000;  // m/s, beyond any rock
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr const char* kAxisNames[3] = {"inline", "crossline", "sample"};

/// The end as float32; nullopt when it is not a number or null. -0 becomes 0, so that equal ranges have one text.
std::optional<float> range_end(const Json& value, float open_end) {
  if (value.is_null()) return open_end;
  if (!value.is_number()) return std::nullopt;
  return static_cast<float>(value.get<double>()) + 0.0f;
}

IsoRange read_range(ObjectReader& request) {
  const Json* value = request.find("range");
  const std::string pointer = request.pointer_to("range");
  if (!value || !value->is_array() || value->size() != 2) {
    request.refuse(pointer, value ? *value : Json(nullptr), "[low, high], a null end being open");
    return {};
  }
  const auto low = range_end((*value)[0], -kInfinity);
  const auto high = range_end((*value)[1], kInfinity);
  if (!low || *low == kInfinity) request.refuse(pointer + "/0", (*value)[0], "a float32 number, or null = open");
  if (!high || *high == -kInfinity) request.refuse(pointer + "/1", (*value)[1], "a float32 number, or null = open");
  if (!low || !high) return {};
  if (*low > *high) request.refuse(pointer, *value, "low <= high");
  return {*low, *high};
}

std::optional<GridBox> read_region(ObjectReader& request, std::optional<Error>& problem) {
  const Json* value = request.find("region");
  if (!value || value->is_null()) return std::nullopt;
  ObjectReader region(*value, request.pointer_to("region"), problem);
  GridBox box;
  for (int axis = 0; axis < 3; ++axis) {
    const Json* ends = region.find(kAxisNames[axis]);
    const bool is_pair = ends && ends->is_array() && ends->size() == 2;
    const auto first = is_pair ? whole_number_of((*ends)[0], 0, kLastNode) : std::nullopt;
    const auto last = is_pair ? whole_number_of((*ends)[1], 0, kLastNode) : std::nullopt;
    if (!first || !last || *first >= *last) {
      region.refuse(region.pointer_to(kAxisNames[axis]), ends ? *ends : Json(nullptr),
                    "[first, last], two node numbers from 0, first < last");
      return std::nullopt;
    }
    box.first[axis] = static_cast<std::int32_t>(*first);
    box.last[axis] = static_cast<std::int32_t>(*last);
  }
  region.refuse_unknown();
  return box;
}

/// One that the server finds by itself, or the id of one that somebody has stored.
void read_grid(ObjectReader& request, ReconstructOptions& options) {
  const Json* value = request.find("grid");
  if (!value) return;
  if (value->is_string() && is_id(value->get<std::string>())) {
    options.grid = GridChoice::curvilinear;
    options.grid_id = value->get<std::string>();
    return;
  }
  for (const GridChoice choice : {GridChoice::given, GridChoice::structural, GridChoice::automatic}) {
    if (*value != name_of(choice)) continue;
    options.grid = choice;
    return;
  }
  request.refuse(request.pointer_to("grid"), *value,
                 R"("given" or "structural" or "auto", or the id of a grid of the volume)");
}

/// Two-way travel times become depths with it.
std::optional<double> read_velocity(ObjectReader& request) {
  const Json* value = request.find("velocity");
  if (!value || value->is_null()) return std::nullopt;
  const double velocity = value->is_number() ? value->get<double>() : 0;
  if (velocity > 0 && velocity <= kFastest) return velocity;
  request.refuse(request.pointer_to("velocity"), *value, "metres a second, above 0 and at most 20000, or null");
  return std::nullopt;
}

void read_codec(ObjectReader& request, ReconstructOptions& options, std::optional<Error>& problem) {
  const Json* value = request.find("codec");
  if (!value) return;
  ObjectReader codec(*value, request.pointer_to("codec"), problem);
  const auto bits = codec.whole_number("position_bits", 7, kMaxPositionBits);
  const auto speed = codec.whole_number("speed", 0, 10);
  options.normals = codec.boolean("normals", options.normals);
  codec.refuse_unknown();
  if (bits) options.position_bits = static_cast<int>(*bits);
  if (speed) options.speed = static_cast<int>(*speed);
}

Json range_end_or_null(float end) {
  return number_or_null(static_cast<double>(end));
}

Json region_document(const GridBox& box) {
  Json region;
  for (int axis = 0; axis < 3; ++axis) region[kAxisNames[axis]] = {box.first[axis], box.last[axis]};
  return region;
}

template <class T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

}  // namespace

Result<ReconstructOptions> parse_request(const Json& document) {
  std::optional<Error> problem;
  ObjectReader request(document, "", problem);
  ReconstructOptions options;
  options.range = read_range(request);
  options.mode = request.choice("mode", {"exact", "sampled"}) == 0 ? BodyMode::exact : BodyMode::sampled;
  read_grid(request, options);
  options.index_space = request.choice("space", {"world", "index"}) == 1;
  options.cap = request.boolean("cap", options.cap);
  options.fill = read_missing(request, problem);
  options.region = read_region(request, problem);
  options.bodies = read_bodies(request, problem);
  options.levels = read_levels(request, options.levels, problem);
  read_simplify(request, options, problem);
  options.velocity = read_velocity(request);
  read_attributes(request, options);
  read_codec(request, options, problem);
  const bool preview = request.boolean("preview", false);
  if (preview && options.grid_id) {
    request.refuse(request.pointer_to("preview"), true, "false on a placed grid, which previews know nothing of");
  }
  request.refuse_unknown();
  if (problem) return *std::move(problem);
  return preview ? preview_options(std::move(options)) : options;
}

Json request_document(const ReconstructOptions& options, GridShape shape) {
  return {{"range", {range_end_or_null(options.range.low), range_end_or_null(options.range.high)}},
          {"mode", options.mode == BodyMode::exact ? "exact" : "sampled"},
          {"missing", missing_document(options.fill)},
          {"grid", options.grid_id.value_or(name_of(options.grid))},
          {"space", options.index_space ? "index" : "world"},
          {"velocity", options.index_space ? Json(nullptr) : or_null(options.velocity)},  // index space has no times
          {"cap", options.cap},
          {"region", region_document(options.region.value_or(whole(shape)))},
          {"bodies", bodies_document(options.bodies)},
          {"levels", levels_document(options.levels)},
          {"simplify", simplify_document(options)},
          {"attributes", attributes_document(options.attributes)},
          {"attribute_volume", or_null(options.attribute_volume)},
          {"codec",
           {{"position_bits", or_null(options.position_bits)},
            {"normals", options.normals},
            {"speed", or_null(options.speed)}}},
          {"preview", options.preview}};
}

Result<Json> range_from_text(std::string_view low, std::string_view high) {
  Json range = Json::array();
  for (const std::string_view text : {low, high}) {
    double number = 0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (problem != std::errc{} || end != text.data() + text.size() || std::isnan(number)) {
      return Error{ErrorCode::invalid_argument,
                   "range end \"" + std::string(text) + "\": expected a number, inf or -inf"};
    }
    const double open_end =
        range.empty() ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
    if (std::isinf(number) && number != open_end) {
      return Error{ErrorCode::invalid_argument, "range end \"" + std::string(text) + "\": nothing lies beyond it"};
    }
    range.push_back(number_or_null(number));
  }
  return range;
}

}  // namespace geosis::server
