#include "server/http/wire/reply_writer.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <exception>
#include <utility>

#include "server/http/routing/error_reply.h"

namespace geosis::server::http {
namespace {

constexpr std::size_t kPullBytes = 64 * 1024;
constexpr std::size_t kTurnBytes = 8 * kPullBytes;
constexpr std::size_t kSizeRoom = 16;  ///< hexadecimal digits of a chunk's size and CRLF
constexpr std::string_view kLineEnd = "\r\n";
constexpr std::string_view kLastChunk = "0\r\n\r\n";

}  // namespace

ReplyWriter::ReplyWriter(Reply reply, const ReplyForm& form, BodyBudget::Share share)
    : share_(std::move(share)), closes_(form.closes) {
  if (!is_writable(reply)) {
    auto on_written = std::move(reply.on_written);
    reply = refusal_reply({500, "the answer could not be written"});
    reply.on_written = std::move(on_written);
  }
  head_ = reply_head(reply, form);
  on_written_ = std::move(reply.on_written);
  pending_[0] = head_;
  if (form.is_head || is_bodiless(reply.status)) return;
  stream_ = std::move(reply.stream);
  left_ = reply.length;
  if (stream_) return;
  body_ = std::move(reply.body);
  shared_ = std::move(reply.shared);
  pending_[1] = shared_ ? *shared_ : body_;
}

ReplyWriter::~ReplyWriter() {
  if (on_written_) on_written_(written_, is_finished_);
}

void ReplyWriter::on_ready(std::function<void()> bell) {
  if (stream_) stream_->on_ready(std::move(bell));
}

ReplyWriter::Outcome ReplyWriter::write(Channel& channel) {
  std::uint64_t turn_end = written_ + kTurnBytes;
  for (;;) {
    while (has_pending()) {
      if (written_ >= turn_end) return Outcome::more;
      if (const auto stopped = send_pending(channel)) return *stopped;
    }
    if (!stream_) {
      is_finished_ = true;
      return Outcome::finished;
    }
    if (written_ >= turn_end) return Outcome::more;
    if (const auto outcome = refill()) return *outcome;
  }
}

std::optional<ReplyWriter::Outcome> ReplyWriter::send_pending(Channel& channel) {
  const Channel::Moved sent = channel.send(pending_);
  if (sent.outcome != Channel::Moved::Outcome::some) {
    return sent.outcome == Channel::Moved::Outcome::blocked ? Outcome::blocked : Outcome::broken;
  }
  written_ += sent.count;
  std::size_t left = sent.count;
  for (std::string_view& piece : pending_) {
    const std::size_t taken = std::min(left, piece.size());
    piece.remove_prefix(taken);
    left -= taken;
  }
  return std::nullopt;
}

std::optional<ReplyWriter::Outcome> ReplyWriter::refill() {
  const std::size_t room = static_cast<std::size_t>(std::min<std::uint64_t>(left_.value_or(kPullBytes), kPullBytes));
  if (room == 0) {  // all of the stated length is written
    stream_.reset();
    return std::nullopt;
  }
  hold_buffer();
  const auto pulled = pull(room);
  if (!pulled || pulled->count > room) return Outcome::broken;
  switch (pulled->state) {
    case ByteStream::Pulled::State::data:
      if (pulled->count == 0) return Outcome::more;
      frame(pulled->count);
      return std::nullopt;
    case ByteStream::Pulled::State::wait:
      buffer_.reset();
      return Outcome::waiting;
    case ByteStream::Pulled::State::end:
      break;
  }
  if (left_) return Outcome::broken;  // shorter than it said
  stream_.reset();
  pending_[0] = kLastChunk;
  return std::nullopt;
}

bool ReplyWriter::say_idle_text() {
  if (!stream_ || left_ || has_pending()) return false;
  const std::string_view text = stream_->idle_text();
  if (text.empty() || text.size() > kPullBytes) return false;
  hold_buffer();
  std::memcpy(buffer_.get() + kSizeRoom, text.data(), text.size());
  frame(text.size());
  return true;
}

void ReplyWriter::hold_buffer() {
  if (!buffer_) buffer_ = std::make_unique_for_overwrite<char[]>(kSizeRoom + kPullBytes + kLineEnd.size());
}

Result<ByteStream::Pulled> ReplyWriter::pull(std::size_t room) {
  try {
    return stream_->pull(std::as_writable_bytes(std::span(buffer_.get() + kSizeRoom, room)));
  } catch (const std::exception&) {
    return Error{ErrorCode::internal, "a stream threw"};
  }
}

void ReplyWriter::frame(std::size_t count) {
  char* const data = buffer_.get() + kSizeRoom;
  if (left_) {
    *left_ -= count;
    pending_[0] = {data, count};
    return;
  }
  std::array<char, kSizeRoom> digits{};
  const char* const end = std::to_chars(digits.data(), digits.data() + digits.size(), count, 16).ptr;
  const auto length = static_cast<std::size_t>(end - digits.data());
  char* const start = data - length - kLineEnd.size();
  std::memcpy(start, digits.data(), length);
  std::memcpy(data - kLineEnd.size(), kLineEnd.data(), kLineEnd.size());
  std::memcpy(data + count, kLineEnd.data(), kLineEnd.size());
  pending_[0] = {start, length + count + 2 * kLineEnd.size()};
}

}  // namespace geosis::server::http
