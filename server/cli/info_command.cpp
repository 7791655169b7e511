#include <cstdio>
#include <filesystem>
#include <memory>

#include "server/cli/commands.h"
#include "server/cli/input.h"
#include "server/cli/progress_bar.h"
#include "server/documents/volume_document.h"

namespace geosis::server {

Command add_info_command(CLI::App& app) {
  auto& command = *app.add_subcommand("info", "Print what a volume file holds, as JSON");
  auto input = std::make_shared<InputArguments>(command);
  return [input]() -> Result<void> {
    ProgressBar progress;
    const auto volume = input->import(progress);
    if (!volume) return volume.error();
    progress.clear();
    const auto name = std::filesystem::path(input->path()).filename().string();
    std::fputs(document_text(volume_document(volume->description, name)).c_str(), stdout);
    return {};
  };
}

}  // namespace geosis::server
