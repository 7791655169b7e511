#include <array>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <memory>
#include <string>
#include <utility>

#include "engine/base/parallel.h"
#include "server/cli/commands.h"
#include "server/cli/input.h"
#include "server/cli/level_files.h"
#include "server/cli/level_table.h"
#include "server/cli/progress_bar.h"
#include "server/documents/request.h"

namespace geosis::server {
namespace {

struct ReconstructArguments {
  explicit ReconstructArguments(CLI::App& command) : input(command) {}

  InputArguments input;
  std::pair<std::string, std::string> range;
  std::string request_path;
  std::string mode;
  std::string region;
  std::string space;
  bool no_cap = false;
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

Result<Json> read_request_file(const std::string& path) {
  constexpr std::size_t kMostBytes = 1 << 20;
  std::ifstream file(path, std::ios::binary);
  if (!file) return Error{ErrorCode::not_found, path + ": cannot be read"};
  std::string text(kMostBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (file.bad()) return Error{ErrorCode::unavailable, path + ": reading failed"};
  if (text.size() > kMostBytes) return Error{ErrorCode::limit_exceeded, path + ": a request has at most 1 MiB"};
  auto document = parse_json(text);
  if (!document) return Error{document.error().code, path + ": " + document.error().message};
  return document;
}

/// "0:75,0:180,0:267" as the request's `region`.
Result<Json> region_from_text(const std::string& text) {
  const Error problem{ErrorCode::invalid_argument, "--region " + text + ": expected I0:I1,J0:J1,K0:K1"};
  std::array<int, 6> ends{};
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::size_t n = 0; n < ends.size(); ++n) {
    const auto parsed = std::from_chars(at, end, ends[n]);
    if (parsed.ec != std::errc{}) return problem;
    at = parsed.ptr;
    if (n == 5) break;
    if (at == end || *at != (n % 2 == 0 ? ':' : ',')) return problem;
    ++at;
  }
  if (at != end) return problem;
  return Json{{"inline", {ends[0], ends[1]}}, {"crossline", {ends[2], ends[3]}}, {"sample", {ends[4], ends[5]}}};
}

/// The request file's document with the flags written over it: both are checked in the same place, parse_request.
Result<Json> requested_document(const ReconstructArguments& arguments) {
  Json document = Json::object();
  if (!arguments.request_path.empty()) {
    auto file = read_request_file(arguments.request_path);
    if (!file) return file;
    document = *std::move(file);
    if (!document.is_object()) return document;
  }
  if (!arguments.range.first.empty()) {
    auto range = range_from_text(arguments.range.first, arguments.range.second);
    if (!range) return range;
    document["range"] = *std::move(range);
  }
  if (!arguments.region.empty()) {
    auto region = region_from_text(arguments.region);
    if (!region) return region;
    document["region"] = *std::move(region);
  }
  if (!arguments.mode.empty()) document["mode"] = arguments.mode;
  if (!arguments.space.empty()) document["space"] = arguments.space;
  if (arguments.no_cap) document["cap"] = false;
  return document;
}

Result<ReconstructOptions> requested_options(const ReconstructArguments& arguments) {
  const auto document = requested_document(arguments);
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

Result<void> run_reconstruct(const ReconstructArguments& arguments) {
  const auto options = requested_options(arguments);
  if (!options) return options.error();
  const auto formats = parse_file_formats(arguments.formats);
  if (!formats) return formats.error();
  auto folder = OutputFolder::open(arguments.out);
  if (!folder) return std::move(folder).error();

  ProgressBar progress;
  Stopwatch total;
  Stopwatch watch;
  const auto volume = arguments.input.import(progress);
  if (!volume) return volume.error();
  const double import_seconds = watch.lap();
  StageTimings timings;
  const auto reconstruction = reconstruct(*volume->samples, volume->description.geometry, *options, progress, &timings);
  if (!reconstruction) return reconstruction.error();
  watch.lap();
  auto written = write_result(*folder, volume->description, *options, *reconstruction, *formats, progress);
  if (written) written = folder->commit(is_result_file);
  if (!written) return written;
  const double write_seconds = watch.lap();

  progress.clear();
  print_volume(volume->description);
  std::fputs(level_table(*reconstruction).c_str(), stdout);
  std::printf("seconds: import %.2f, extract %.2f, simplify %.2f, encode %.2f, certify %.2f, write %.2f, total %.2f\n",
              import_seconds, timings.extract, timings.simplify, timings.encode, timings.certify, write_seconds,
              total.lap());
  return {};
}

}  // namespace

Command add_reconstruct_command(CLI::App& app) {
  auto& command = *app.add_subcommand("reconstruct", "Surface of the body in an amplitude range, in levels of detail");
  auto arguments = std::make_shared<ReconstructArguments>(command);
  // Two values always: an end may look like a flag (-inf).
  command.add_option("--range", arguments->range, "the body is {LOW <= amplitude <= HIGH}; -inf and inf are open ends")
      ->type_name("LOW HIGH");
  command.add_option("--request", arguments->request_path, "request as JSON; flags win over it")->type_name("FILE");
  command.add_option("--mode", arguments->mode, "exact (default) or sampled: g = (f - LOW)(HIGH - f) on the samples")
      ->type_name("MODE");
  command.add_flag("--no-cap", arguments->no_cap, "leave the body open where it leaves the survey");
  command.add_option("--region", arguments->region, "nodes to look at, from 0, ends included")
      ->type_name("I0:I1,J0:J1,K0:K1");
  command.add_option("--space", arguments->space, "world (default) or index")->type_name("SPACE");
  command.add_option("--out", arguments->out, "folder for manifest.json and the levels")->capture_default_str();
  command.add_option("--formats", arguments->formats, "files of each level: drc (always written), glb, ply, obj, stl")
      ->capture_default_str();
  command.add_option("--threads", arguments->threads, "threads to use")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  return [arguments] { return run_reconstruct(*arguments); };
}

}  // namespace geosis::server
