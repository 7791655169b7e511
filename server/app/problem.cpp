#include "server/app/problem.h"

#include <string>
#include <string_view>

#include "server/app/errors.h"

namespace geosis::server {
namespace {

/// A message about a document: the JSON pointer before its colon, and what it says after it.
struct Located {
  std::string pointer, detail;
};

Located locate(const std::string& message) {
  constexpr std::string_view kDocument = "request ";
  const std::size_t start = message.starts_with(kDocument) ? kDocument.size() : 0;
  const std::size_t colon = message.find(": ", start);
  if (colon == std::string::npos || message[start] != '/') return {{}, message};
  return {message.substr(start, colon - start), message.substr(colon + 2)};
}

bool ends_path(char c) {
  return c == ' ' || c == '"' || c == '\'' || c == ',' || c == ';' || c == ')' || c == '\n';
}

/// The message without absolute paths of files: what lies where on this machine is nobody's business. Paths of this
/// service's own (/v1/...) and names after a single slash (JSON pointers) stay.
std::string without_paths(const std::string& message) {
  std::string result;
  for (std::size_t at = 0; at < message.size();) {
    const bool may_begin = message[at] == '/' && (at == 0 || ends_path(message[at - 1]) || message[at - 1] == '(');
    std::size_t end = at + 1;
    while (may_begin && end < message.size() && !ends_path(message[end])) ++end;
    std::string_view word = std::string_view(message).substr(at, may_begin ? end - at : 1);
    if (may_begin && word.ends_with(':')) word.remove_suffix(1);
    const bool is_path = may_begin && word.find('/', 1) != std::string_view::npos && !word.starts_with("/v1/");
    result += is_path ? "a file" : std::string(word);
    at += word.size();
  }
  return result;
}

}  // namespace

Json problem_document(const Error& error) {
  const ErrorNumbers& numbers = numbers_of(error.code);
  const Located located = locate(error.message);
  Json problem = {{"type", std::string("urn:geosis:problem:") + name_of(error.code)},
                  {"title", numbers.title},
                  {"status", numbers.http_status},
                  {"detail", without_paths(located.detail)},
                  {"code", name_of(error.code)}};
  if (!located.pointer.empty()) problem["pointer"] = located.pointer;
  return problem;
}

}  // namespace geosis::server
