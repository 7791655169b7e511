#include "server/documents/request_levels.h"

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace geosis::server {
namespace {

constexpr std::int64_t kMostLevels = 16;
constexpr double kNoCap = std::numeric_limits<double>::infinity();
constexpr std::int64_t kLargestSeed = std::int64_t{1} << 53;  // beyond, JSON numbers have holes

/// How coarse a level can be asked to be, and what its number must satisfy.
struct Measure {
  const char* name;
  std::optional<double> LevelTarget::*target;
  bool falls;  ///< level by level; others grow
};
constexpr std::array<Measure, 3> kMeasures = {{{"ratio", &LevelTarget::ratio, true},
                                               {"max_error", &LevelTarget::max_error, false},
                                               {"max_cost", &LevelTarget::max_cost, false}}};

bool is_number(const Json* value) {
  return value && value->is_number() && std::isfinite(value->get<double>());
}

void read_measure(ObjectReader& level, const Measure& measure, LevelTarget& target) {
  const Json* value = level.find(measure.name);
  if (!value || value->is_null()) return;
  const double number = is_number(value) ? value->get<double>() : 0;
  if (!(number > 0) || (measure.falls && number > 1)) {
    level.refuse(level.pointer_to(measure.name), *value, measure.falls ? "a number in (0, 1]" : "a number above 0");
  }
  target.*measure.target = number;
}

/// Exactly one measure, and coarser than the last level that has the same.
void check_measures(ObjectReader& level, const std::string& pointer, const Json& entry, const LevelTarget& target,
                    std::array<std::optional<double>, 3>& previous) {
  int measures = 0;
  for (std::size_t n = 0; n < kMeasures.size(); ++n) {
    const auto& now = target.*kMeasures[n].target;
    if (!now) continue;
    ++measures;
    const auto before = std::exchange(previous[n], now);
    if (before && (kMeasures[n].falls ? *now >= *before : *now <= *before)) {
      level.refuse(level.pointer_to(kMeasures[n].name), Json(*now),
                   std::string(kMeasures[n].falls ? "less" : "more") + " than the level before it has");
    }
  }
  if (measures != 1) level.refuse(pointer, entry, "one of ratio, max_error and max_cost");
}

void read_cap(ObjectReader& level, LevelTarget& target) {
  const Json* value = level.find("error_cap");
  if (!value) return;  // the default
  target.error_cap = kNoCap;
  if (value->is_null()) return;
  if (is_number(value) && value->get<double>() >= 0) {
    target.error_cap = value->get<double>() + 0.0;
  } else {
    level.refuse(level.pointer_to("error_cap"), *value, "voxels from 0 on, or null = none");
  }
}

void read_drop(ObjectReader& level, LevelTarget& target, std::optional<Error>& problem) {
  const Json* value = level.find("drop");
  if (!value || value->is_null()) return;
  ObjectReader drop(*value, level.pointer_to("drop"), problem);
  for (const auto& [name, bound] :
       {std::pair("max_voxels", &target.drop.max_voxels), std::pair("max_error", &target.drop.max_error)}) {
    const Json* number = drop.find(name);
    if (!number || number->is_null()) continue;
    if (is_number(number) && number->get<double>() >= 0) {
      *bound = number->get<double>() + 0.0;
    } else {
      drop.refuse(drop.pointer_to(name), *number, "a number from 0 on");
    }
  }
  drop.refuse_unknown();
}

/// What stops the level beside its measure; null = nothing.
Json cap_document(const LevelTarget& level) {
  const bool has_default = level.ratio && *level.ratio < 1;
  const double cap = level.error_cap.value_or(has_default ? default_error_cap(*level.ratio) : kNoCap);
  return level.ratio && *level.ratio == 1 ? Json(nullptr) : number_or_null(cap);
}

}  // namespace

std::vector<LevelTarget> read_levels(ObjectReader& request, std::vector<LevelTarget> otherwise,
                                     std::optional<Error>& problem) {
  const Json* value = request.find("levels");
  if (!value || value->is_null()) return otherwise;
  const std::string pointer = request.pointer_to("levels");
  if (!value->is_array() || value->empty() || value->size() > kMostLevels) {
    request.refuse(pointer, *value, "an array of 1 to " + std::to_string(kMostLevels) + " levels");
    return otherwise;
  }
  std::vector<LevelTarget> levels;
  std::array<std::optional<double>, 3> previous;
  for (const Json& entry : *value) {
    const std::string place = pointer + "/" + std::to_string(levels.size());
    ObjectReader level(entry, place, problem);
    LevelTarget& target = levels.emplace_back();
    for (const Measure& measure : kMeasures) read_measure(level, measure, target);
    read_cap(level, target);
    read_drop(level, target, problem);
    level.refuse_unknown();
    check_measures(level, place, entry, target, previous);
  }
  return levels;
}

Json asked_document(const LevelTarget& level) {
  for (const Measure& measure : kMeasures) {
    if (const auto& number = level.*measure.target) return {{measure.name, *number}};
  }
  return Json::object();
}

Json levels_document(const std::vector<LevelTarget>& levels) {
  Json list = Json::array();
  for (const LevelTarget& level : levels) {
    Json entry = asked_document(level);
    entry["error_cap"] = cap_document(level);
    entry["drop"] = {{"max_voxels", level.drop.max_voxels}, {"max_error", level.drop.max_error}};
    list.push_back(std::move(entry));
  }
  return list;
}

void read_simplify(ObjectReader& request, ReconstructOptions& options, std::optional<Error>& problem) {
  const Json* value = request.find("simplify");
  if (!value || value->is_null()) return;
  ObjectReader simplify(*value, request.pointer_to("simplify"), problem);
  options.strategy = static_cast<Strategy>(simplify.choice("strategy", {"greedy", "multiple_choice"}));
  options.placement = static_cast<Placement>(simplify.choice("placement", {"optimal", "subset"}));
  options.seed = static_cast<std::uint64_t>(simplify.whole_number("seed", 0, kLargestSeed).value_or(0));
  simplify.refuse_unknown();
}

/// The greedy strategy draws no random numbers: its seed is 0.
Json simplify_document(const ReconstructOptions& options) {
  const bool draws = options.strategy == Strategy::multiple_choice;
  return {{"strategy", draws ? "multiple_choice" : "greedy"},
          {"placement", options.placement == Placement::subset ? "subset" : "optimal"},
          {"seed", draws ? options.seed : 0}};
}

}  // namespace geosis::server
