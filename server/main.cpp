#include "server/cli/commands.h"
#include "server/service/key_command.h"
#include "server/service/probe_command.h"
#include "server/service/serve_command.h"

int main(int argc, char** argv) {
  return geosis::server::run_command_line(
      argc, argv,
      {geosis::server::add_serve_command, geosis::server::add_key_command, geosis::server::add_probe_command});
}
