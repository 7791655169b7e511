#pragma once

#include <atomic>
#include <cstring>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "server/app/byte_stream.h"

namespace geosis::server::http {

/// What a test and the stream it handed to the front both hold.
struct Tap {
  std::mutex mutex;
  std::string bytes;  ///< that may be pulled
  bool is_ended = false, fails = false;
  std::function<void()> bell;
  std::atomic<bool> is_destroyed = false;

  void pour(const std::string& more, bool ends = false) {
    std::function<void()> ring;
    {
      const std::lock_guard lock(mutex);
      bytes += more;
      is_ended = ends;
      ring = bell;
    }
    if (ring) ring();
  }
};

/// A stream that waits until the test pours something into its tap.
class TapStream final : public ByteStream {
 public:
  explicit TapStream(std::shared_ptr<Tap> tap) : tap_(std::move(tap)) {}
  ~TapStream() override { tap_->is_destroyed = true; }

  Result<Pulled> pull(std::span<std::byte> into) override {
    const std::lock_guard lock(tap_->mutex);
    if (tap_->fails) return Error{ErrorCode::internal, "broken tap"};
    if (tap_->bytes.empty()) return Pulled{tap_->is_ended ? Pulled::State::end : Pulled::State::wait, 0};
    const std::size_t count = std::min(into.size(), tap_->bytes.size());
    std::memcpy(into.data(), tap_->bytes.data(), count);
    tap_->bytes.erase(0, count);
    return Pulled{Pulled::State::data, count};
  }
  void on_ready(std::function<void()> bell) override {
    const std::lock_guard lock(tap_->mutex);
    tap_->bell = std::move(bell);
  }

 private:
  std::shared_ptr<Tap> tap_;
};

/// The byte at a place of a CountedStream.
inline char counted_byte(std::uint64_t place) {
  return static_cast<char>('a' + place % 23);
}

/// So many bytes, each told by its place; never waits.
class CountedStream final : public ByteStream {
 public:
  explicit CountedStream(std::uint64_t bytes, std::atomic<std::uint64_t>* pulled = nullptr)
      : bytes_(bytes), pulled_(pulled) {}

  Result<Pulled> pull(std::span<std::byte> into) override {
    if (place_ == bytes_) return Pulled{Pulled::State::end, 0};
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(into.size(), bytes_ - place_));
    for (std::size_t i = 0; i < count; ++i) into[i] = static_cast<std::byte>(counted_byte(place_ + i));
    place_ += count;
    if (pulled_) *pulled_ += count;
    return Pulled{Pulled::State::data, count};
  }
  void on_ready(std::function<void()>) override {}

 private:
  std::uint64_t bytes_, place_ = 0;
  std::atomic<std::uint64_t>* pulled_;
};

inline std::string counted_text(std::uint64_t first, std::uint64_t count) {
  std::string text;
  for (std::uint64_t place = first; place < first + count; ++place) text += counted_byte(place);
  return text;
}

}  // namespace geosis::server::http
