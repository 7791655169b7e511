#include "server/service/key_command.h"

#include <cstdio>
#include <memory>
#include <string>

#include "server/auth/api_keys.h"

namespace geosis::server {
namespace {

struct KeyArguments {
  std::string name = "key", tenant = "default", scopes = "volumes:read,volumes:write";
};

Result<void> print_key(const KeyArguments& arguments) {
  const auto scopes = parse_scopes(arguments.scopes);
  if (!scopes) {
    return Error{ErrorCode::invalid_argument, "--scopes: expected volumes:read, volumes:write, or both with a comma"};
  }
  const auto made = make_key({arguments.name, arguments.tenant, *scopes});
  if (!made) return made.error();
  std::fprintf(stderr, "geosis: the key, which is nowhere kept, then the line for the file of --auth api_keys FILE\n");
  std::printf("%s\n%s\n", made->key.c_str(), made->line.c_str());
  return {};
}

}  // namespace

Command add_key_command(CLI::App& app) {
  auto& command = *app.add_subcommand("key", "Make a key for the service, and the line of its file that lets it in");
  auto arguments = std::make_shared<KeyArguments>();
  command.add_option("--name", arguments->name, "what logs call its holder")->capture_default_str();
  command.add_option("--tenant", arguments->tenant, "whose volumes it opens")->capture_default_str();
  command.add_option("--scopes", arguments->scopes, "what it may do")->capture_default_str();
  return [arguments] { return print_key(*arguments); };
}

}  // namespace geosis::server
