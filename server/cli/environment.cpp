#include "server/cli/environment.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <sstream>

namespace geosis::server {
namespace {

std::string variable_of(const std::string& flag) {
  std::string name = "GEOSIS_";
  for (const char c : flag) name += c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return name;
}

bool is_given(const std::vector<std::string>& arguments, const std::string& flag) {
  return std::any_of(arguments.begin(), arguments.end(), [&](const std::string& argument) {
    return argument == "--" + flag || argument.starts_with("--" + flag + "=");
  });
}

void add_flag(const CLI::Option& option, const std::string& flag, const std::string& text,
              std::vector<std::string>& arguments) {
  if (option.get_items_expected_max() <= 1) {
    arguments.push_back("--" + flag + "=" + text);
    return;
  }
  arguments.push_back("--" + flag);
  std::istringstream values(text);
  for (std::string value; values >> value;) arguments.push_back(value);
}

}  // namespace

std::vector<std::string> with_environment(const CLI::App& app, std::vector<std::string> arguments) {
  for (const CLI::App* command : app.get_subcommands({})) {
    if (std::find(arguments.begin(), arguments.end(), command->get_name()) == arguments.end()) continue;
    for (const CLI::Option* option : command->get_options()) {
      for (const std::string& flag : option->get_lnames()) {
        const char* const text = std::getenv(variable_of(flag).c_str());
        const bool is_set = text != nullptr && *text != '\0';
        if (is_set && flag != "help" && !is_given(arguments, flag)) add_flag(*option, flag, text, arguments);
      }
    }
    break;
  }
  return arguments;
}

}  // namespace geosis::server
