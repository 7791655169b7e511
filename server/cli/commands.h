#pragma once

#include <functional>
#include <vector>

#include <CLI/CLI.hpp>

#include "engine/base/result.h"

namespace geosis::server {

/// What a subcommand does once its arguments are parsed; it prints its results on stdout itself.
using Command = std::function<Result<void>()>;

/// Adds a subcommand to the program and says what it does.
using AddCommand = Command (*)(CLI::App&);

Command add_reconstruct_command(CLI::App& app);
Command add_info_command(CLI::App& app);
Command add_synth_command(CLI::App& app);

/// Parses the command line, the environment (GEOSIS_<FLAG>) and the file of --config, in this order of weight; runs one
/// command, prints at most one line of error on stderr ("geosis: code: message").
///
/// more      commands beside those of this room.
/// returns   the exit status: 0, 1 = the command failed, 2 = the command line makes no sense.
int run_command_line(int argc, const char* const* argv, std::vector<AddCommand> more = {});

}  // namespace geosis::server
