#include "server/http/uploads/upload_body.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <string_view>
#include <utility>

#include <poll.h>

namespace geosis::server::http {
namespace {

constexpr std::size_t kWireBytes = 64 * 1024;
constexpr std::size_t kWakeBytes = 1024 * 1024;
constexpr int kPollMilliseconds = 250;

}  // namespace

UploadBody::UploadBody(Channel& channel, const Head& head, std::string already, const Limits& limits)
    : channel_(channel),
      buffer_(std::move(already)),
      left_(head.is_chunked ? limits.upload_bytes : head.content_length.value_or(0)),
      is_chunked_(head.is_chunked),
      rate_(limits.upload_bytes_per_second, limits.rate_window) {}

Result<std::size_t> UploadBody::read(std::span<std::byte> into) {
  if (error_) return *error_;
  if (into.empty()) return std::size_t{0};
  auto count = is_chunked_ ? read_chunked(into) : read_counted(into);
  if (!count) error_ = count.error();
  return count;
}

Result<std::size_t> UploadBody::read_counted(std::span<std::byte> into) {
  const auto room = static_cast<std::size_t>(std::min<std::uint64_t>(into.size(), left_));
  if (room == 0) return std::size_t{0};
  auto count = receive(into.first(room));
  if (count) left_ -= *count;
  return count;
}

Result<std::size_t> UploadBody::read_chunked(std::span<std::byte> into) {
  for (;;) {
    auto count = decode_buffered(into);
    if (!count || *count > 0 || decoder_.is_finished()) return count;
    buffer_.resize(kWireBytes);
    begin_ = buffer_.size();  // nothing is buffered while we wait
    const auto received = receive(std::as_writable_bytes(std::span(buffer_)));
    if (!received) return received.error();
    buffer_.resize(*received);
    begin_ = 0;
  }
}

Result<std::size_t> UploadBody::decode_buffered(std::span<std::byte> into) {
  const auto step = decoder_.decode(std::string_view(buffer_).substr(begin_), into);
  if (!step) return step.error();
  begin_ += step->consumed;
  if (step->produced > left_) return Error{ErrorCode::limit_exceeded, "the body is larger than this server takes"};
  left_ -= step->produced;
  return step->produced;
}

Result<std::size_t> UploadBody::receive(std::span<std::byte> into) {
  if (begin_ < buffer_.size()) {
    const std::size_t count = std::min(into.size(), buffer_.size() - begin_);
    std::memcpy(into.data(), buffer_.data() + begin_, count);
    begin_ += count;
    return count;
  }
  for (;;) {
    const Channel::Moved received = channel_.receive({reinterpret_cast<char*>(into.data()), into.size()});
    switch (received.outcome) {
      case Channel::Moved::Outcome::some:
        rate_.add(received.count, {});
        return received.count;
      case Channel::Moved::Outcome::blocked:
        if (auto waited = wait_for_bytes(); !waited) return std::move(waited).error();
        break;
      case Channel::Moved::Outcome::ended:
        return Error{ErrorCode::malformed_input, "the body ends before its stated end"};
      case Channel::Moved::Outcome::broken:
        return Error{ErrorCode::malformed_input, "the connection broke before the body's stated end"};
    }
  }
}

Result<void> UploadBody::wait_for_bytes() {
  const auto start = std::chrono::steady_clock::now();
  // Of a chunked body nobody knows how much is to come.
  const std::size_t wanted = is_chunked_ ? 1 : static_cast<std::size_t>(std::min<std::uint64_t>(left_, kWakeBytes));
  if (wanted != wake_at_) channel_.wake_at(wake_at_ = wanted);
  pollfd event{channel_.socket(), static_cast<short>(channel_.read_event()), 0};  // POLLIN is EPOLLIN
  ::poll(&event, 1, kPollMilliseconds);
  if (rate_.add(0, std::chrono::steady_clock::now() - start)) return {};
  return Error{ErrorCode::deadline_exceeded, "the body arrives too slowly"};
}

}  // namespace geosis::server::http
