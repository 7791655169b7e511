#pragma once

#include "server/cli/commands.h"

namespace geosis::server {

/// `geosis key`: makes a key for the service and the line of its key file that lets it in.
Command add_key_command(CLI::App& app);

}  // namespace geosis::server
