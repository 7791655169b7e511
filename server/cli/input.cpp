#include "server/cli/input.h"

#include <algorithm>

#include "server/documents/import_options.h"

namespace geosis::server {
namespace {

std::string flag_of(std::string name) {
  std::replace(name.begin(), name.end(), '_', '-');
  return "--" + name;
}

/// The refusal of a file that several pairs of header bytes fit, with the flags that choose one.
std::string choices(const std::vector<GridCandidate>& candidates) {
  std::string text = "SEG-Y: several pairs of header bytes make a grid; give one of";
  for (const auto& candidate : candidates) {
    text += (&candidate == &candidates.front() ? " --inline-byte " : ", --inline-byte ") +
            std::to_string(candidate.inline_byte) + " --crossline-byte " + std::to_string(candidate.crossline_byte) +
            " (" + std::to_string(candidate.shape.inlines) + " x " + std::to_string(candidate.shape.crosslines) +
            " traces, " + std::to_string(candidate.missing_traces) + " missing)";
  }
  return text;
}

}  // namespace

InputArguments::InputArguments(CLI::App& command) {
  command.add_option("INPUT", path_, "volume file: SEG-Y, or raw samples with --dims")->required();
  for (const auto& option : import_option_names()) {
    command.add_option(flag_of(option.name), texts_[option.name], option.help)
        ->type_name(option.value)
        ->group("Import options");
  }
}

Result<ImportedVolume> InputArguments::import(Progress& progress) const {
  ImportOptions options;
  for (const auto& [name, text] : texts_) {
    if (text.empty()) continue;
    if (auto set = set_import_option(options, name, text); !set) return std::move(set).error();
  }
  auto source = open_file(path_);
  if (!source) return std::move(source).error();
  std::vector<GridCandidate> candidates;
  auto volume = import_volume(**source, options, std::nullopt, progress, &candidates);
  if (volume) return volume;
  return Error{volume.error().code, path_ + ": " + (candidates.empty() ? volume.error().message : choices(candidates))};
}

}  // namespace geosis::server
