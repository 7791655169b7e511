#pragma once

#include <atomic>
#include <chrono>
#include <cstring>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "server/app/byte_stream.h"
#include "server/http/routing/exchange.h"

namespace geosis::server::http {

/// What a test and the stream it handed to the front both hold.
struct Tap {
  std::mutex mutex;
  std::string bytes;  ///< that may be pulled
  bool is_ended = false, fails = false;
  std::string idle_text;
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
  std::string_view idle_text() const override { return tap_->idle_text; }

 private:
  std::shared_ptr<Tap> tap_;
};

/// What a test and the pending answer it handed to the front both hold.
struct Promise {
  std::mutex mutex;
  std::function<void()> bell;
  std::atomic<bool> is_kept = false, is_destroyed = false;
  std::chrono::milliseconds time{10'000};
  bool can_end_early = false;

  void keep() {
    is_kept = true;
    std::function<void()> ring;
    {
      const std::lock_guard lock(mutex);
      ring = bell;
    }
    if (ring) ring();
  }
};

/// Answers "kept" or "late" once the test keeps the promise, or its time is over.
class PromisedReply final : public PendingReply {
 public:
  explicit PromisedReply(std::shared_ptr<Promise> promise) : promise_(std::move(promise)) {}
  ~PromisedReply() override { promise_->is_destroyed = true; }

  void on_ready(std::function<void()> bell) override {
    const std::lock_guard lock(promise_->mutex);
    promise_->bell = std::move(bell);
  }
  bool is_ready() const override { return promise_->is_kept; }
  std::chrono::steady_clock::time_point deadline() const override { return deadline_; }
  bool can_end_early() const override { return promise_->can_end_early; }
  Reply finish() override {
    Reply reply;
    reply.body = promise_->is_kept ? "kept" : "late";
    return reply;
  }

 private:
  std::shared_ptr<Promise> promise_;
  std::chrono::steady_clock::time_point deadline_ = std::chrono::steady_clock::now() + promise_->time;
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
