#include "server/grpc/calls/chunk_inbox.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>
#include <span>
#include <utility>

#include "engine/base/hexadecimal.h"

namespace geosis::server::rpc {
namespace {

constexpr std::size_t kMostHeld = 2 << 20;  // bytes
constexpr std::chrono::milliseconds kLook{250};

}  // namespace

ChunkInbox::ChunkInbox(Options options, std::function<void()> ask_for_more)
    : options_(std::move(options)),
      ask_for_more_(std::move(ask_for_more)),
      rate_(options_.bytes_per_second, options_.window) {}

void ChunkInbox::expect(std::string sha256, std::optional<std::uint64_t> bytes) {
  const std::lock_guard lock(mutex_);
  sha256_ = std::move(sha256);
  stated_bytes_ = bytes;
}

bool ChunkInbox::put(Slices chunk) {
  std::uint64_t bytes = 0;
  for (const grpc::Slice& slice : chunk) bytes += slice.size();
  const std::lock_guard lock(mutex_);
  if (broken_) return false;
  received_ += bytes;
  if (received_ > options_.most_bytes) {
    broken_ = Error{ErrorCode::limit_exceeded, "the file is larger than the " + std::to_string(options_.most_bytes) +
                                                   " bytes that this server takes"};
  } else if (bytes > 0) {
    held_ += bytes;
    std::move(chunk.begin(), chunk.end(), std::back_inserter(arrived_));
  }
  changed_.notify_one();
  if (broken_) return false;
  is_asking_owed_ = held_ >= kMostHeld;
  return !is_asking_owed_;
}

void ChunkInbox::end() {
  const std::lock_guard lock(mutex_);
  has_ended_ = true;
  if (!broken_ && received_ != stated_bytes_.value_or(received_)) {
    broken_ = Error{ErrorCode::malformed_input, "file cut short, or too long: " + std::to_string(received_) +
                                                    " bytes arrived of " + std::to_string(*stated_bytes_)};
  }
  changed_.notify_one();
}

void ChunkInbox::break_off(Error error) {
  const std::lock_guard lock(mutex_);
  if (!broken_) broken_ = std::move(error);
  changed_.notify_one();
}

Result<std::size_t> ChunkInbox::read(std::span<std::byte> into) {
  {
    std::unique_lock lock(mutex_);
    if (broken_) return *broken_;
    if (is_all_read()) {
      if (auto came = wait(lock); !came) return std::move(came).error();
      reading_.clear();
      reading_.swap(arrived_);
      next_ = 0;
    }
  }
  const std::size_t count = take(into);
  release(count);
  rate_.add(count, {});
  if (!sha256_.empty()) digest_.update(into.first(count));
  return count;
}

std::size_t ChunkInbox::take(std::span<std::byte> into) {
  std::size_t count = 0;
  while (!is_all_read() && count < into.size()) {
    const grpc::Slice& slice = reading_[next_];
    const std::size_t piece = std::min(into.size() - count, slice.size() - begin_);
    std::memcpy(into.data() + count, slice.begin() + begin_, piece);
    count += piece;
    begin_ += piece;
    if (begin_ < slice.size()) break;
    reading_[next_++] = grpc::Slice();  // gRPC's memory is free again
    begin_ = 0;
  }
  return count;
}

void ChunkInbox::release(std::size_t count) {
  bool asks = false;
  {
    const std::lock_guard lock(mutex_);
    held_ -= count;
    asks = held_ < kMostHeld && std::exchange(is_asking_owed_, false);
  }
  if (asks) ask_for_more_();
}

Result<void> ChunkInbox::wait(std::unique_lock<std::mutex>& lock) {
  while (!broken_ && arrived_.empty() && !has_ended_) {
    const auto start = std::chrono::steady_clock::now();
    changed_.wait_for(lock, kLook);
    if (rate_.add(0, std::chrono::steady_clock::now() - start)) continue;
    broken_ = Error{ErrorCode::deadline_exceeded, "the file arrives too slowly"};
  }
  if (broken_) return *broken_;
  return {};
}

Result<void> ChunkInbox::check() {
  if (sha256_.empty()) return {};
  std::array<std::byte, 4096> rest;
  for (;;) {
    const auto count = read(rest);
    if (!count) return count.error();
    if (*count == 0) break;
  }
  const std::string stated = hexadecimal(std::as_bytes(std::span(sha256_))), found = std::move(digest_).hex();
  if (found == stated) return {};
  return Error{ErrorCode::invalid_argument, "/sha256: " + stated + "; that of the file is " + found};
}

}  // namespace geosis::server::rpc
