#pragma once

#include <array>
#include <charconv>
#include <cstddef>
#include <cstring>
#include <ostream>
#include <string>
#include <string_view>

#include "engine/base/result.h"

namespace geosis {

/// Collects small pieces and hands them to a stream 64 KiB at a time: writing a record costs no virtual call.
class StreamBuffer {
 public:
  explicit StreamBuffer(std::ostream& stream) : stream_(stream) {}

  void append(std::string_view text) { append_bytes(text.data(), text.size()); }

  /// The value's bytes as they lie in memory.
  template <class T>
  void append_raw(const T& value) {
    append_bytes(&value, sizeof(T));
  }

  /// The shortest decimal that reads back as the same number.
  template <class Number>
  void append_decimal(Number number) {
    std::array<char, 32> digits;  // the longest double has 24 characters
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
    append_bytes(digits.data(), static_cast<std::size_t>(end - digits.data()));
  }

  /// Sends what is left; tells whether the stream took everything so far.
  Result<void> finish() {
    flush();
    if (stream_) return {};
    return Error{ErrorCode::unavailable, "the output stream failed after " + std::to_string(sent_) + " bytes"};
  }

 private:
  void append_bytes(const void* bytes, std::size_t count) {
    if (used_ + count > buffer_.size()) flush();
    std::memcpy(buffer_.data() + used_, bytes, count);
    used_ += count;
  }

  void flush() {
    if (stream_.write(buffer_.data(), static_cast<std::streamsize>(used_))) sent_ += used_;
    used_ = 0;
  }

  std::ostream& stream_;
  std::array<char, 65536> buffer_;
  std::size_t used_ = 0;
  std::size_t sent_ = 0;
};

}  // namespace geosis
