#pragma once

#include <string>
#include <utility>

namespace geosis::server::http {

/// What a program that saves the answer calls it: the beginning of its id, then `rest`. Not the name of the volume,
/// which may change while answers are kept for ever.
///
/// id, rest   without anything that a quoted string would have to escape.
inline std::pair<std::string, std::string> download_name(const std::string& id, const std::string& rest) {
  constexpr std::size_t kShortId = 12;
  return {"Content-Disposition", "inline; filename=\"" + id.substr(0, kShortId) + "-" + rest + "\""};
}

}  // namespace geosis::server::http
