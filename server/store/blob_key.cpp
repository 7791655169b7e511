#include "server/store/blob_key.h"

#include <algorithm>
#include <cstddef>
#include <string>

namespace geosis::server {
namespace {

constexpr std::size_t kMaxKeyBytes = 512;
constexpr std::size_t kMaxSegmentBytes = 255;  // what file systems take as one name

bool is_key_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' || c == '-';
}

bool are_segments(std::string_view path) {
  while (true) {
    const std::size_t end = std::min(path.find('/'), path.size());
    if (!is_key_segment(path.substr(0, end))) return false;
    if (end == path.size()) return true;
    path.remove_prefix(end + 1);
  }
}

// The text as a message may show it: short and printable.
std::string shown(std::string_view text) {
  std::string result(text.substr(0, 80));
  for (char& c : result)
    if (!is_key_character(c) && c != '/') c = '?';
  if (text.size() > result.size()) result += "... (" + std::to_string(text.size()) + " bytes)";
  return "\"" + result + "\"";
}

}  // namespace

bool is_key_segment(std::string_view name) {
  return !name.empty() && name.size() <= kMaxSegmentBytes && name != "." && name != ".." &&
         std::all_of(name.begin(), name.end(), is_key_character);
}

Result<void> check_key(std::string_view key) {
  if (key.size() <= kMaxKeyBytes && are_segments(key)) return {};
  return Error{ErrorCode::invalid_argument, shown(key) + " is not a blob's key"};
}

Result<void> check_prefix(std::string_view prefix) {
  if (prefix.empty()) return {};
  if (prefix.size() <= kMaxKeyBytes && prefix.back() == '/' && are_segments(prefix.substr(0, prefix.size() - 1)))
    return {};
  return Error{ErrorCode::invalid_argument, shown(prefix) + " is not a prefix of blob keys"};
}

}  // namespace geosis::server
