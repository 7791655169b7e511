#include "server/documents/request_sections.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>

namespace geosis::server {
namespace {

constexpr std::size_t kMostSeeds = 1000;
constexpr std::int64_t kLastNode = std::numeric_limits<std::int32_t>::max() - 1;
constexpr const char* kAttributeNames[] = {"reliability", "body", "value", "agreement"};

std::array<bool*, 4> flags_of(AttributeChoice& choice) {
  return {&choice.reliability, &choice.body, &choice.value, &choice.agreement};
}

/// A number in [min, infinity), or (min, infinity) when `above`; nullopt when absent or null.
std::optional<double> number(ObjectReader& reader, const char* name, double min, bool above) {
  const Json* member = reader.find(name);
  if (!member || member->is_null()) return std::nullopt;
  const double value = member->is_number() ? member->get<double>() : std::numeric_limits<double>::quiet_NaN();
  if (!std::isfinite(value) || !(above ? value > min : value >= min)) {
    reader.refuse(
        reader.pointer_to(name), *member,
        std::string(above ? "a number above " : "a number of at least ") + std::to_string(int(min)) + " or null");
    return std::nullopt;
  }
  return value;
}

std::optional<GridIndex> node_of(const Json& value) {
  if (!value.is_array() || value.size() != 3) return std::nullopt;
  GridIndex node;
  for (int axis = 0; axis < 3; ++axis) {
    const auto index = whole_number_of(value[static_cast<std::size_t>(axis)], 0, kLastNode);
    if (!index) return std::nullopt;
    node[axis] = static_cast<std::int32_t>(*index);
  }
  return node;
}

std::vector<GridIndex> read_seeds(ObjectReader& bodies) {
  const Json* value = bodies.find("seeds");
  if (!value || value->is_null()) return {};
  const std::string pointer = bodies.pointer_to("seeds");
  if (!value->is_array() || value->size() > kMostSeeds) {
    bodies.refuse(pointer, *value, "at most " + std::to_string(kMostSeeds) + " nodes");
    return {};
  }
  std::vector<GridIndex> seeds;
  for (const Json& entry : *value) {
    const auto node = node_of(entry);
    if (!node) bodies.refuse(pointer + "/" + std::to_string(seeds.size()), entry, "[i, j, k], node numbers from 0");
    seeds.push_back(node.value_or(GridIndex{}));
  }
  const auto order = [](GridIndex n) { return std::tuple(n.i, n.j, n.k); };
  std::sort(seeds.begin(), seeds.end(), [&](GridIndex a, GridIndex b) { return order(a) < order(b); });
  seeds.erase(std::unique(seeds.begin(), seeds.end()), seeds.end());
  return seeds;
}

}  // namespace

FillOptions read_missing(ObjectReader& request, std::optional<Error>& problem) {
  const Json* value = request.find("missing");
  if (!value) return {};
  ObjectReader missing(*value, request.pointer_to("missing"), problem);
  FillOptions fill;
  fill.method = static_cast<FillMethod>(missing.choice("method", {"none", "linear", "rbf"}));
  fill.kernel = static_cast<RbfKernel>(missing.choice("kernel", {"polyharmonic", "inverse_distance"}));
  fill.steer = static_cast<FillSteering>(missing.choice("steer", {"auto", "on", "off"}));
  fill.max_distance = number(missing, "max_distance", 0, true);
  missing.refuse_unknown();
  return fill;
}

Json missing_document(const FillOptions& fill) {
  const bool is_rbf = fill.method == FillMethod::rbf;
  const bool is_plate = is_rbf && fill.kernel == RbfKernel::polyharmonic;
  const bool has_distance = fill.method != FillMethod::none && fill.max_distance;
  static constexpr const char* kMethods[] = {"none", "linear", "rbf"};
  static constexpr const char* kSteering[] = {"auto", "on", "off"};
  return {{"method", kMethods[static_cast<int>(fill.method)]},
          {"kernel", is_rbf && !is_plate ? "inverse_distance" : "polyharmonic"},
          {"steer", kSteering[is_plate ? static_cast<int>(fill.steer) : 0]},
          {"max_distance", has_distance ? Json(*fill.max_distance) : Json(nullptr)}};
}

BodyChoice read_bodies(ObjectReader& request, std::optional<Error>& problem) {
  const Json* value = request.find("bodies");
  if (!value) return {};
  ObjectReader bodies(*value, request.pointer_to("bodies"), problem);
  BodyChoice choice;
  choice.min_voxels = number(bodies, "min_voxels", 0, false).value_or(0) + 0.0;  // -0 has the text of 0
  const auto largest = bodies.whole_number("largest", 1, std::numeric_limits<std::int32_t>::max());
  if (largest) choice.largest = static_cast<std::uint32_t>(*largest);
  choice.seeds = read_seeds(bodies);
  bodies.refuse_unknown();
  return choice;
}

Json bodies_document(const BodyChoice& bodies) {
  Json seeds = Json::array();
  for (const GridIndex& seed : bodies.seeds) seeds.push_back({seed.i, seed.j, seed.k});
  return {{"min_voxels", bodies.min_voxels},
          {"largest", bodies.largest ? Json(*bodies.largest) : Json(nullptr)},
          {"seeds", std::move(seeds)}};
}

void read_attributes(ObjectReader& request, ReconstructOptions& options) {
  if (const Json* value = request.find("attributes")) {
    options.attributes = {.reliability = false, .body = false, .value = false};
    const std::string pointer = request.pointer_to("attributes");
    if (!value->is_array())
      request.refuse(pointer, *value, "a list of \"reliability\", \"body\", \"value\" and \"agreement\"");
    for (std::size_t n = 0; value->is_array() && n < value->size(); ++n) {
      const auto* const name = std::find(std::begin(kAttributeNames), std::end(kAttributeNames), (*value)[n]);
      if (name == std::end(kAttributeNames)) {
        request.refuse(pointer + "/" + std::to_string(n), (*value)[n],
                       "\"reliability\", \"body\", \"value\" or \"agreement\"");
        continue;
      }
      *flags_of(options.attributes)[static_cast<std::size_t>(name - kAttributeNames)] = true;
    }
  }
  const Json* volume = request.find("attribute_volume");
  const Json given = volume ? *volume : Json(nullptr);
  if (given.is_string()) options.attribute_volume = given.get<std::string>();
  const bool is_right_type = given.is_string() || given.is_null();
  if (!is_right_type || options.attribute_volume.has_value() != options.attributes.value) {
    request.refuse(request.pointer_to("attribute_volume"), given,
                   options.attributes.value ? "the id of the volume that the attribute \"value\" is of"
                                            : "null, as \"attributes\" does not ask for \"value\"");
  }
}

Json attributes_document(const AttributeChoice& attributes) {
  AttributeChoice choice = attributes;
  Json names = Json::array();
  const auto flags = flags_of(choice);
  for (std::size_t n = 0; n < flags.size(); ++n) {
    if (*flags[n]) names.push_back(kAttributeNames[n]);
  }
  return names;
}

}  // namespace geosis::server
