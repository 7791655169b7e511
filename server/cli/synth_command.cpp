#include <cstdio>
#include <memory>
#include <string>

#include "engine/volume/formats/segy_write.h"
#include "engine/volume/synthetic_survey.h"
#include "server/cli/commands.h"
#include "server/cli/progress_bar.h"
#include "server/documents/import_options.h"

namespace geosis::server {
namespace {

struct SynthArguments {
  std::string path;
  std::string dims;
  std::string kind = "channel";
  std::string missing = "both";
  std::uint64_t seed = 1;
};

/// Bins of 25 m, turned against north by the 3-4-5 triangle's angle; samples of 4 ms from 1 s on.
SegySurvey survey_headers(const SyntheticSurveyOptions& options) {
  SegySurvey survey;
  survey.shape = options.shape;
  survey.inline_axis = {.first = 1001, .step = 1};
  survey.crossline_axis = {.first = 2001, .step = 1};
  survey.sample_axis = {.first = 1000, .step = 4};
  survey.geometry = AffineGeometry({456000, 6781000, 1000}, {20, 15, 0}, {-15, 20, 0}, {0, 0, 4});
  survey.text = "Made-up survey, written by geosis synth: not field data\nseed " + std::to_string(options.seed);
  return survey;
}

Result<SyntheticSurveyOptions> survey_options(const SynthArguments& arguments) {
  SyntheticSurveyOptions options;
  if (!arguments.dims.empty()) {
    ImportOptions parsed;  // dims are written as for raw files
    if (!set_import_option(parsed, "dims", arguments.dims)) {
      return Error{ErrorCode::invalid_argument, "--dims " + arguments.dims + ": expected I,J,K"};
    }
    options.shape = *parsed.dims;
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (options.shape[axis] < 2) {
      return Error{ErrorCode::invalid_argument, "--dims " + arguments.dims + ": at least 2 an axis"};
    }
  }
  options.kind = arguments.kind == "reflectors" ? SurveyKind::reflectors : SurveyKind::channel;
  options.seed = arguments.seed;
  options.polygon = arguments.missing == "polygon" || arguments.missing == "both";
  options.holes = arguments.missing == "holes" || arguments.missing == "both";
  return options;
}

Result<void> write_survey(const SynthArguments& arguments) {
  const auto options = survey_options(arguments);
  if (!options) return options.error();
  const SyntheticSurvey survey(*options);
  ProgressBar progress;
  return write_segy(
      arguments.path, survey_headers(*options),
      [&](std::int32_t i, std::int32_t j, std::span<float> samples) { survey.fill_trace(i, j, samples); },
      [&](std::int32_t i, std::int32_t j) { return survey.has_trace(i, j); }, progress);
}

}  // namespace

Command add_synth_command(CLI::App& app) {
  auto& command = *app.add_subcommand("synth", "Write a made-up survey as SEG-Y");
  auto arguments = std::make_shared<SynthArguments>();
  command.add_option("OUT", arguments->path, "the SEG-Y file to write")->required();
  command.add_option("--dims", arguments->dims, "number of inlines, crosslines, samples (160,200,160)")
      ->type_name("I,J,K");
  command.add_option("--kind", arguments->kind, "a bright channel in folded reflectors, or the reflectors alone")
      ->check(CLI::IsMember({"channel", "reflectors"}))
      ->capture_default_str();
  command.add_option("--seed", arguments->seed, "another seed is another survey")->capture_default_str();
  command.add_option("--missing", arguments->missing, "traces left out: outside a polygon, in holes, both or none")
      ->check(CLI::IsMember({"polygon", "holes", "both", "none"}))
      ->capture_default_str();
  return [arguments] { return write_survey(*arguments); };
}

}  // namespace geosis::server
