#include "server/http/routing/parameters.h"

#include <algorithm>
#include <charconv>
#include <utility>

namespace geosis::server::http {
namespace {

constexpr int kLongestWaitSeconds = 60;

Error refuse(std::string_view name, const std::string& text, const std::string& expected) {
  return {ErrorCode::invalid_argument, "parameter " + std::string(name) + ": \"" + text + "\"; expected " + expected};
}

std::optional<std::int64_t> whole_number(std::string_view text) {
  std::int64_t number = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (problem != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// Calls visit(element) for each element of a comma-separated header.
template <class Visit>
void each_element(std::string_view list, const Visit& visit) {
  while (!list.empty()) {
    const std::size_t comma = std::min(list.find(','), list.size());
    visit(trimmed(list.substr(0, comma)));
    list.remove_prefix(std::min(comma + 1, list.size()));
  }
}

}  // namespace

std::string header(const Request& request, const std::string& name) {
  const auto found = request.headers.find(name);
  return found == request.headers.end() ? std::string() : found->second;
}

std::optional<std::string> parameter(const Request& request, const std::string& name) {
  const auto found = request.query.find(name);
  if (found == request.query.end()) return std::nullopt;
  return found->second;
}

Result<std::int64_t> whole_parameter(const Request& request, const std::string& name, std::int64_t otherwise,
                                     std::int64_t min, std::int64_t max) {
  const auto text = parameter(request, name);
  if (!text) return otherwise;
  const auto number = whole_number(*text);
  if (!number || *number < min || *number > max) {
    return refuse(name, *text, "a whole number from " + std::to_string(min) + " to " + std::to_string(max));
  }
  return *number;
}

Result<bool> flag_parameter(const Request& request, const std::string& name, bool otherwise) {
  const auto text = parameter(request, name);
  if (!text) return otherwise;
  if (*text == "true" || *text == "1") return true;
  if (*text == "false" || *text == "0") return false;
  return refuse(name, *text, "true or false");
}

Result<std::pair<std::string, std::string>> pair_of(std::string_view name, const std::string& text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos) return refuse(name, text, "LOW,HIGH");
  return std::pair{text.substr(0, comma), text.substr(comma + 1)};
}

Result<void> only_parameters(const Request& request, std::initializer_list<std::string_view> known) {
  for (const auto& [name, value] : request.query) {
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      return Error{ErrorCode::invalid_argument, "parameter " + name + ": there is no such parameter"};
    }
  }
  return {};
}

Preference preference(const Request& request) {
  Preference wanted;
  const std::string text = header(request, "prefer");
  each_element(text, [&](std::string_view element) {
    if (element == "respond-async") wanted.respond_async = true;
    if (!element.starts_with("wait=")) return;
    const auto seconds = whole_number(element.substr(5));
    if (seconds && *seconds >= 0)
      wanted.wait_seconds = static_cast<int>(std::min<std::int64_t>(*seconds, kLongestWaitSeconds));
  });
  return wanted;
}

bool accepts(const Request& request, std::string_view media_type) {
  bool found = false;
  const std::string text = header(request, "accept");
  each_element(text, [&](std::string_view element) {
    found = found || trimmed(element.substr(0, element.find(';'))) == media_type;
  });
  return found;
}

}  // namespace geosis::server::http
