#include <algorithm>
#include <cstdio>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "server/cli/commands.h"
#include "server/cli/environment.h"

namespace geosis::server {
namespace {

constexpr int kFailed = 1;
constexpr int kUsage = 2;

/// The message as one line: errors quote names and bytes of files, which may hold anything.
std::string one_line(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = ' ';
  }
  return text;
}

int failed(const char* code, const std::string& message) {
  std::fprintf(stderr, "geosis: %s: %s\n", code, one_line(message).c_str());
  return kFailed;
}

int run(const Command& command) {
  try {
    const auto done = command();
    return done ? 0 : failed(name_of(done.error().code), done.error().message);
  } catch (const std::bad_alloc&) {
    return failed(name_of(ErrorCode::limit_exceeded), "out of memory");
  }
}

/// What is wrong with the command line; CLI11 only says that a command is needed when the word in its place is none.
std::string usage_problem(const CLI::App& app, const CLI::ParseError& problem) {
  const auto left = app.remaining();
  if (!app.get_subcommands().empty() || left.empty() || left.front().starts_with('-')) return problem.what();
  std::string commands;
  for (const CLI::App* command : app.get_subcommands({})) commands += " " + command->get_name();
  return "there is no command " + left.front() + "; commands are" + commands;
}

}  // namespace

int run_command_line(int argc, const char* const* argv, std::vector<AddCommand> more) {
  CLI::App app("Geosis: seismic volumes to reservoir bodies", "geosis");
  app.set_version_flag("--version", "geosis " GEOSIS_VERSION);
  app.require_subcommand(1);
  app.fallthrough();
  app.set_config("--config", "", "file with names of flags, a section for each command: [serve]");
  std::vector<std::pair<CLI::App*, Command>> commands;
  more.insert(more.begin(), {add_reconstruct_command, add_info_command, add_synth_command});
  for (const AddCommand add : more) {
    Command command = add(app);
    commands.emplace_back(app.get_subcommands({}).back(), std::move(command));
  }
  try {
    auto arguments = with_environment(app, {argv + std::min(argc, 1), argv + argc});
    std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them from the back
    app.parse(std::move(arguments));
  } catch (const CLI::Success& wanted) {  // --help, --version
    return app.exit(wanted);
  } catch (const CLI::ParseError& problem) {
    std::fprintf(stderr, "geosis: usage: %s (geosis --help)\n", one_line(usage_problem(app, problem)).c_str());
    return kUsage;
  }
  for (const auto& [subcommand, command] : commands) {
    if (subcommand->parsed()) return run(command);
  }
  return kUsage;
}

}  // namespace geosis::server
