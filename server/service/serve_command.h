#pragma once

#include "server/cli/commands.h"

namespace geosis::server {

/// `geosis serve`: every flag is also an environment variable GEOSIS_<FLAG>, and a name in the [serve] section of a
/// file given by --config; flag > environment > file.
Command add_serve_command(CLI::App& app);

}  // namespace geosis::server
