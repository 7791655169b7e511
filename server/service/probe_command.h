#pragma once

#include "server/cli/commands.h"

namespace geosis::server {

/// `geosis probe URL`: whether a server answers 2xx, for images and hosts without an HTTP client. Over TLS the
/// certificate must be for the host and of an authority that the system knows, unless flags say otherwise.
Command add_probe_command(CLI::App& app);

}  // namespace geosis::server
