#include "server/documents/grid_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "engine/pipeline/grid_stage.h"

namespace geosis::server {
namespace {

constexpr const char* kAxisNames[] = {"inline", "crossline"};

std::string two_digits(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", number);
  return text;
}

Json quantiles_document(const DipQuantiles& dips) {
  return {{"median", dips.median}, {"p95", dips.p95}, {"p99", dips.p99}};
}

/// NaN when it is not there.
double number_in(const Json& document, const char* name) {
  const auto found = document.find(name);
  return found != document.end() && found->is_number() ? found->get<double>() : std::nan("");
}

}  // namespace

const char* name_of(GridChoice choice) {
  switch (choice) {
    case GridChoice::given:
      return "given";
    case GridChoice::structural:
      return "structural";
    case GridChoice::automatic:
      return "auto";
    case GridChoice::curvilinear:
      return "curvilinear";
  }
  return "given";
}

Json dips_document(const DipReport& dips) {
  return {{"period", dips.period},
          {"inline", quantiles_document(dips.dips[0])},
          {"crossline", quantiles_document(dips.dips[1])},
          {"warped", dips.warped}};
}

Result<DipReport> parse_dips_document(const Json& document) {
  const Error malformed = {ErrorCode::malformed_input, "dips: not the document of a volume's dips"};
  if (!document.is_object()) return malformed;
  DipReport report;
  report.period = number_in(document, "period");
  bool is_sound = std::isfinite(report.period);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const auto quantiles = document.find(kAxisNames[axis]);
    if (quantiles == document.end() || !quantiles->is_object()) return malformed;
    DipQuantiles& dips = report.dips[axis];
    dips = {number_in(*quantiles, "median"), number_in(*quantiles, "p95"), number_in(*quantiles, "p99")};
    is_sound = is_sound && std::isfinite(dips.median) && std::isfinite(dips.p95) && std::isfinite(dips.p99);
  }
  const auto warped = document.find("warped");
  if (!is_sound || warped == document.end() || !warped->is_boolean()) return malformed;
  report.warped = warped->get<bool>();
  return report;
}

bool is_beyond_trace(const DipReport& dips, std::int32_t samples) {
  return dips.period > samples;
}

GridDecision decide_grid(const DipReport& dips, std::optional<std::int32_t> samples) {
  const bool is_structural = prefers_structure(dips);
  const double steep = std::max(dips.dips[0].p95, dips.dips[1].p95);
  const bool is_beyond = samples && is_beyond_trace(dips, *samples);
  const std::string period = is_beyond ? "the dominant period, which is longer than a trace"
                                       : "the dominant period of " + two_digits(dips.period) + " samples";
  return {is_structural, "95 % of the dips are within " + two_digits(steep) + " samples a trace, which is " +
                             (is_structural ? "more" : "not more") + " than an eighth of " + period};
}

Json grid_document(GridChoice asked, const GridReport& report) {
  Json document = {{"asked", name_of(asked)},
                   {"chosen", report.structure ? "structural" : "given"},
                   {"because", asked == GridChoice::automatic ? decide_grid(report.dips).because : "it was asked for"},
                   {"dips", dips_document(report.dips)}};
  if (report.structure) {
    document["layers"] = report.layers;
    document["unreliable_share"] = report.structure->unreliable_share;
    document["untied_share"] = report.structure->untied_share;
  }
  return document;
}

Json placed_grid_document(const std::string& id, const NodeReport& nodes, std::optional<double> lattice_step) {
  return {{"asked", id},
          {"chosen", name_of(GridChoice::curvilinear)},
          {"because", "it was asked for"},
          {"id", id},
          {"mirrored", nodes.mirrored},
          {"folded_share", nodes.folded_share},
          {"lattice_step", lattice_step ? number_or_null(*lattice_step) : Json(nullptr)}};
}

}  // namespace geosis::server
