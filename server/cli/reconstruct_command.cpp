#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "engine/base/parallel.h"
#include "engine/pipeline/describe_bodies.h"
#include "engine/pipeline/grid_stage.h"
#include "engine/pipeline/stages.h"
#include "server/cli/commands.h"
#include "server/cli/grid_arguments.h"
#include "server/cli/input.h"
#include "server/cli/level_files.h"
#include "server/cli/level_table.h"
#include "server/cli/progress_bar.h"
#include "server/cli/request_arguments.h"
#include "server/documents/grid_report.h"
#include "server/documents/ids.h"
#include "server/documents/manifest.h"
#include "server/documents/node_grid_document.h"
#include "server/documents/request.h"
#include "server/documents/request_check.h"

namespace geosis::server {
namespace {

struct ReconstructArguments {
  explicit ReconstructArguments(CLI::App& command) : input(command), request(command), grid(command) {}

  InputArguments input;
  RequestArguments request;
  GridArguments grid;
  std::string out = "out";
  std::string formats = "drc";
  int threads = default_threads();
};

class Stopwatch {
 public:
  /// Seconds since construction or the last lap.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(now - std::exchange(start_, now)).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

Result<ReconstructOptions> requested_options(const ReconstructArguments& arguments) {
  const auto document = arguments.request.document();
  if (!document) return document.error();
  auto options = parse_request(*document);
  if (options) options->threads = arguments.threads;
  return options;
}

void print_volume(const VolumeDescription& volume) {
  std::printf("%d inlines x %d crosslines x %d samples, %lld of %lld traces missing, amplitudes %g to %g\n",
              volume.shape.inlines, volume.shape.crosslines, volume.shape.samples,
              static_cast<long long>(volume.missing_traces),
              static_cast<long long>(volume.shape.inlines) * volume.shape.crosslines,
              static_cast<double>(volume.value_range.min), static_cast<double>(volume.value_range.max));
  for (const auto& warning : volume.warnings)
    std::printf("warning: %s: %s\n", warning.code.c_str(), warning.detail.c_str());
}

void print_grid(GridChoice asked, const GridReport& report, std::int32_t samples) {
  if (asked == GridChoice::automatic) std::printf("grid: %s\n", decide_grid(report.dips, samples).because.c_str());
  if (report.nodes) {
    std::printf("grid: curvilinear%s, %.2f %% of the cells folded\n", report.nodes->mirrored ? ", mirrored" : "",
                100 * report.nodes->folded_share);
    return;
  }
  if (!report.structure) {
    std::printf("grid: as given\n");
    return;
  }
  std::printf("grid: structural, %d layers; %.1f %% of the samples unreliable, %.1f %% of the links not tied\n",
              report.layers, 100 * report.structure->unreliable_share, 100 * report.structure->untied_share);
}

/// The grid of the files given, whose id is what the request names.
Result<std::optional<NodeGrid>> open_grid(const ReconstructArguments& arguments, const VolumeDescription& volume,
                                          ReconstructOptions& options, Progress& progress) {
  auto grid = arguments.grid.open(volume, options.threads, progress);
  if (!grid) return grid;
  const auto refusal = [](const std::string& what) {
    return Error{ErrorCode::invalid_argument, "request /grid: " + what};
  };
  if (!*grid) {
    if (options.grid_id) return refusal("give the grid's file, --grid-nodes for example");
    return grid;
  }
  const std::string& id = (*grid)->summary.digest;
  if (options.grid_id && *options.grid_id != id) return refusal("the grid in the files is another one, " + id);
  if (options.grid != GridChoice::given && !options.grid_id) {
    return refusal(std::string(name_of(options.grid)) + ", but the files give a grid; leave out one of them");
  }
  options.grid = GridChoice::curvilinear;
  options.grid_id = id;
  const Json document = node_grid_document((*grid)->summary, "", arguments.grid.kind());
  if (auto checked = check_placed_grid(options, document); !checked) return std::move(checked).error();
  return grid;
}

/// The volume that the attribute `value` is of, whose id takes the place of its file's name.
Result<std::optional<ImportedVolume>> import_attribute_volume(const ReconstructArguments& arguments,
                                                              const VolumeSummary& volume, ReconstructOptions& options,
                                                              Progress& progress) {
  if (!options.attribute_volume) return std::optional<ImportedVolume>();
  const std::string& path = arguments.request.attribute_volume();
  if (path.empty()) {
    return Error{ErrorCode::invalid_argument, "request /attribute_volume: give the volume's file, --attribute-volume"};
  }
  auto source = open_file(path);
  if (!source) return std::move(source).error();
  auto imported = import_volume(**source, {}, std::nullopt, progress);
  if (!imported) return Error{imported.error().code, path + ": " + imported.error().message};
  if (auto fits = check_attribute_volume(summarize(imported->description), volume); !fits) {
    return std::move(fits).error();
  }
  options.attribute_volume = volume_id(imported->description);
  return std::optional(*std::move(imported));
}

Result<void> run_reconstruct(const ReconstructArguments& arguments) {
  auto options = requested_options(arguments);
  if (!options) return std::move(options).error();
  const auto formats = parse_file_formats(arguments.formats);
  if (!formats) return formats.error();
  auto folder = OutputFolder::open(arguments.out);
  if (!folder) return std::move(folder).error();

  ProgressBar progress;
  Stopwatch total;
  Stopwatch watch;
  const auto volume = arguments.input.import(progress);
  if (!volume) return volume.error();
  VolumeSummary summary = summarize(volume->description);
  if (auto checked = check_request(*options, summary); !checked) return checked;
  const auto nodes = open_grid(arguments, volume->description, *options, progress);
  if (!nodes) return nodes.error();
  if (*nodes) summary = placed_on(summary, (*nodes)->summary);
  const auto other = import_attribute_volume(arguments, summary, *options, progress);
  if (!other) return other.error();
  const double import_seconds = watch.lap();
  StageTimings timings;
  ReconstructInput input{.samples = *volume->samples,
                         .geometry = volume->description.geometry,
                         .has_lengths = has_lengths(summary, *options),
                         .attribute_volume = *other ? (*other)->samples.get() : nullptr,
                         .nodes = *nodes ? &(*nodes)->geometry : nullptr};
  const auto grid = grid_stage(input, *options, progress);  // once for both that follow
  if (!grid) return grid.error();
  input.grid = grid->structural;
  if (grid->report) input.dips = &grid->report->dips;
  const double grid_seconds = watch.lap();
  const auto filled = fill_stage(input, *options, progress);  // once for both that follow
  if (!filled) return filled.error();
  input.filled = filled->filled;
  const double fill_seconds = watch.lap();
  const auto reconstruction = reconstruct(input, *options, progress, &timings);
  if (!reconstruction) return reconstruction.error();
  watch.lap();
  const auto bodies = describe_bodies(input, *options, progress);
  if (!bodies) return bodies.error();
  const double bodies_seconds = watch.lap();
  auto written = write_result(*folder, summary, *options, {*reconstruction, *bodies}, *formats, progress);
  if (written) written = folder->commit(is_result_file);
  if (!written) return written;
  const double write_seconds = watch.lap();

  progress.clear();
  print_volume(volume->description);
  if (reconstruction->grid) print_grid(options->grid, *reconstruction->grid, summary.shape.samples);
  std::fputs(level_table(*reconstruction).c_str(), stdout);
  std::fputs(body_table(*bodies).c_str(), stdout);
  std::printf(
      "seconds: import %.2f, grid %.2f, fill %.2f, extract %.2f, simplify %.2f, encode %.2f, certify %.2f, "
      "bodies %.2f, write %.2f, total %.2f\n",
      import_seconds, grid_seconds, fill_seconds, timings.extract, timings.simplify, timings.encode, timings.certify,
      bodies_seconds, write_seconds, total.lap());
  return {};
}

}  // namespace

Command add_reconstruct_command(CLI::App& app) {
  auto& command = *app.add_subcommand("reconstruct", "Surface of the body in an amplitude range, in levels of detail");
  auto arguments = std::make_shared<ReconstructArguments>(command);
  command.add_option("--out", arguments->out, "folder for manifest.json and the levels")->capture_default_str();
  command.add_option("--formats", arguments->formats, "files of each level: drc (always written), glb, ply, obj, stl")
      ->capture_default_str();
  command.add_option("--threads", arguments->threads, "threads to use")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  return [arguments] { return run_reconstruct(*arguments); };
}

}  // namespace geosis::server
