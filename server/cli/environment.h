#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace geosis::server {

/// The command line with what the environment says added: --max-body of the subcommand in use is also GEOSIS_MAX_BODY.
/// A flag that is given wins over its variable, and both over a configuration file. A flag of several values has them
/// parted by spaces in its variable. An empty variable is none: container files pass on what nobody has set as "".
std::vector<std::string> with_environment(const CLI::App& app, std::vector<std::string> arguments);

}  // namespace geosis::server
