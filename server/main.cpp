#include "server/cli/commands.h"

int main(int argc, char** argv) {
  return geosis::server::run_command_line(argc, argv);
}
