#include <cstdio>
#include <filesystem>
#include <memory>

#include "engine/base/parallel.h"
#include "engine/pipeline/grid_stage.h"
#include "server/cli/commands.h"
#include "server/cli/grid_arguments.h"
#include "server/cli/input.h"
#include "server/cli/progress_bar.h"
#include "server/documents/grid_report.h"
#include "server/documents/node_grid_document.h"
#include "server/documents/volume_document.h"

namespace geosis::server {

Command add_info_command(CLI::App& app) {
  auto& command = *app.add_subcommand("info", "Print what a volume file holds, as JSON");
  auto input = std::make_shared<InputArguments>(command);
  auto grid = std::make_shared<GridArguments>(command);
  return [input, grid]() -> Result<void> {
    ProgressBar progress;
    const auto volume = input->import(progress);
    if (!volume) return volume.error();
    const auto dips = report_dips(*volume->samples, default_threads(), progress);
    if (!dips) return dips.error();
    const auto nodes = grid->open(volume->description, default_threads(), progress);
    if (!nodes) return nodes.error();
    progress.clear();
    const auto name = std::filesystem::path(input->path()).filename().string();
    Json document = volume_document(volume->description, name);
    const GridDecision decision = decide_grid(*dips, volume->description.shape.samples);
    document["structure"] = dips_document(*dips);
    if (is_beyond_trace(*dips, volume->description.shape.samples)) document["structure"]["period"] = nullptr;
    document["structure"]["auto"] = name_of(decision.is_structural ? GridChoice::structural : GridChoice::given);
    document["structure"]["because"] = decision.because;
    if (*nodes) {
      document["grid"] = node_grid_document((*nodes)->summary, document.at("id").get<std::string>(), grid->kind());
    }
    std::fputs(document_text(document).c_str(), stdout);
    return {};
  };
}

}  // namespace geosis::server
