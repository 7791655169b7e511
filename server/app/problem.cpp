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

}  // namespace

Json problem_document(const Error& error) {
  const ErrorNumbers& numbers = numbers_of(error.code);
  const Located located = locate(error.message);
  Json problem = {{"type", std::string("urn:geosis:problem:") + name_of(error.code)},
                  {"title", numbers.title},
                  {"status", numbers.http_status},
                  {"detail", located.detail},
                  {"code", name_of(error.code)}};
  if (!located.pointer.empty()) problem["pointer"] = located.pointer;
  return problem;
}

}  // namespace geosis::server
