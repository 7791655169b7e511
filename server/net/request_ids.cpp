#include "server/net/request_ids.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <random>

#include "engine/base/hexadecimal.h"

namespace geosis::server {
namespace {

constexpr std::size_t kLongestId = 128;

/// A counter that starts at a random place.
std::string new_request_id() {
  static std::atomic<std::uint64_t> next = (std::uint64_t{std::random_device{}()} << 32) | std::random_device{}();
  std::array<char, 16> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), next.fetch_add(1), 16).ptr;
  return std::string(digits.data(), end);
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/// Hexadecimal digits in lower case, as many as stated, not all of them 0.
bool is_trace_field(std::string_view text, std::size_t digits) {
  return text.size() == digits && is_lower_hexadecimal(text) && text.find_first_not_of('0') != std::string_view::npos;
}

}  // namespace

std::string request_id_of(std::string_view stated) {
  const auto is_sane = [](char c) { return is_digit(c) || is_letter(c) || c == '.' || c == '_' || c == '-'; };
  const bool is_usable =
      !stated.empty() && stated.size() <= kLongestId && std::all_of(stated.begin(), stated.end(), is_sane);
  return is_usable ? std::string(stated) : new_request_id();
}

std::string trace_id_of(std::string_view traceparent) {
  // version-trace-parent-flags: 00-<32>-<16>-<2>; later versions may append fields.
  const std::string_view text = traceparent;
  if (text.size() < 55) return {};
  const std::string_view version = text.substr(0, 2);
  const bool has_dashes = text[2] == '-' && text[35] == '-' && text[52] == '-';
  const bool is_known = version == "00" ? text.size() == 55 : is_trace_field(version, 2) && version != "ff";
  if (!has_dashes || !is_known || !is_trace_field(text.substr(36, 16), 16)) return {};
  const std::string_view trace = text.substr(3, 32);
  return is_trace_field(trace, 32) ? std::string(trace) : std::string();
}

}  // namespace geosis::server
