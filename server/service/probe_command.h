#pragma once

#include "server/cli/commands.h"

namespace geosis::server {

/// `geosis probe URL`: whether a server answers 2xx, for images and hosts without an HTTP client. Without TLS: the
/// admin door never has it.
Command add_probe_command(CLI::App& app);

}  // namespace geosis::server
