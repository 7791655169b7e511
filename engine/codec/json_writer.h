#pragma once

#include <array>
#include <charconv>
#include <cstddef>
#include <string>
#include <string_view>

namespace geosis {

/// Writes JSON piece by piece: begin('{').key("a").value(1).end('}'). For texts of known names; nothing is escaped.
/// Numbers are the shortest that read back as the same double.
class JsonWriter {
 public:
  JsonWriter& begin(char bracket) {
    separate();
    text_ += bracket;
    first_ = true;
    return *this;
  }
  JsonWriter& end(char bracket) {
    text_ += bracket;
    first_ = false;
    return *this;
  }
  JsonWriter& key(std::string_view name) {
    value(name);
    text_ += ':';
    first_ = true;
    return *this;
  }
  JsonWriter& value(std::string_view plain) {
    separate();
    text_ += '"';
    text_ += plain;
    text_ += '"';
    return *this;
  }
  JsonWriter& value(const char* plain) { return value(std::string_view(plain)); }
  JsonWriter& value(bool flag) {
    separate();
    text_ += flag ? "true" : "false";
    return *this;
  }
  JsonWriter& value(int number) { return decimal(number); }
  JsonWriter& value(std::size_t number) { return decimal(number); }
  /// number   finite.
  JsonWriter& value(double number) { return decimal(number); }

  template <class Numbers>
  JsonWriter& list(const Numbers& numbers) {
    begin('[');
    for (const auto number : numbers) value(number);
    return end(']');
  }

  const std::string& text() const { return text_; }

 private:
  void separate() {
    if (!first_) text_ += ',';
    first_ = false;
  }
  template <class Number>
  JsonWriter& decimal(Number number) {
    separate();
    std::array<char, 32> digits;  // the longest double has 24 characters
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
    text_.append(digits.data(), static_cast<std::size_t>(end - digits.data()));
    return *this;
  }

  std::string text_;
  bool first_ = true;
};

}  // namespace geosis
