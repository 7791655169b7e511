#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace geosis {

/// Two lower-case digits for each byte.
inline std::string hexadecimal(std::span<const std::byte> bytes) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  text.reserve(2 * bytes.size());
  for (const std::byte byte : bytes) {
    text += kDigits[std::to_integer<unsigned>(byte) >> 4];
    text += kDigits[std::to_integer<unsigned>(byte) & 15];
  }
  return text;
}

/// The value of a digit in either case; -1 for what is none.
constexpr int hexadecimal_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

constexpr bool is_lower_hexadecimal(std::string_view text) {
  return std::all_of(text.begin(), text.end(),
                     [](char c) { return hexadecimal_digit(c) >= 0 && (c < 'A' || c > 'F'); });
}

/// Fills as many bytes as there are pairs of digits. returns  whether they were as many, and nothing but digits.
inline bool read_hexadecimal(std::string_view text, std::span<std::byte> into) {
  if (text.size() != 2 * into.size()) return false;
  for (std::size_t n = 0; n < into.size(); ++n) {
    const int high = hexadecimal_digit(text[2 * n]), low = hexadecimal_digit(text[2 * n + 1]);
    if (high < 0 || low < 0) return false;
    into[n] = static_cast<std::byte>(16 * high + low);
  }
  return true;
}

}  // namespace geosis
