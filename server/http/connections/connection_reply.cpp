#include <algorithm>
#include <utility>

#include "server/http/connections/connection.h"

// From an answer to the next request, or the connection's end.

namespace geosis::server::http {

void Connection::suspend(std::unique_ptr<Suspended> suspended) {
  if (is_half_closed_) return finish();
  suspended_ = std::move(suspended);
  state_ = State::suspended;
  suspended_->pending->on_ready(owner_.bell_of(*this));
  on_bell();  // what came before the bell was hung up
}

void Connection::resume() {
  state_ = State::handling;
  owner_.resume(*this, std::move(suspended_));
}

void Connection::answer(std::unique_ptr<ReplyWriter> writer) {
  if (is_half_closed_ && writer->has_stream()) return finish();
  closes_ = closes_ || writer->closes();
  writer_ = std::move(writer);
  const Limits& limits = owner_.limits();
  const auto in_time = writer_->held_bytes() / static_cast<std::uint64_t>(limits.hold_time.count());
  rate_.set_rate(std::max(limits.bytes_per_second, in_time));
  if (writer_->has_stream()) writer_->on_ready(owner_.bell_of(*this));
  write();
}

void Connection::write() {
  state_ = State::writing;
  const bool was_blocked = blocked_since_.has_value();
  const auto outcome = writer_->write(*channel_);
  if (was_blocked && !judge_rate()) return drop();
  blocked_since_.reset();
  switch (outcome) {
    case ReplyWriter::Outcome::finished:
      written_before_ += writer_->bytes_written();
      writer_.reset();
      return closes_ ? linger() : next_request();
    case ReplyWriter::Outcome::blocked:
    case ReplyWriter::Outcome::more:  // the socket may be full by now as well
      blocked_since_ = Clock::now();
      return;
    case ReplyWriter::Outcome::waiting:
      state_ = State::waiting;
      quiet_since_ = Clock::now();
      return;
    case ReplyWriter::Outcome::broken:
      return finish();
  }
}

bool Connection::judge_rate() {
  if (!blocked_since_) return true;
  const auto now = Clock::now();
  const std::uint64_t taken = bytes_taken();
  const bool is_fast_enough = rate_.add(taken - std::min(taken, judged_bytes_), now - *blocked_since_);
  judged_bytes_ = taken;
  blocked_since_ = now;
  return is_fast_enough;
}

std::uint64_t Connection::bytes_taken() const {
  const std::uint64_t written = written_before_ + writer_->bytes_written();
  return written - std::min(written, channel_->unsent());
}

void Connection::next_request() {
  const Limits& limits = owner_.limits();
  state_ = State::reading_head;
  idle_since_ = Clock::now();
  deadline_ = idle_since_ + (in_.empty() ? limits.idle_timeout : limits.head_deadline);
  if (!in_.empty() && !is_advancing_) advance();
}

void Connection::linger() {
  // Closing with unread bytes would reset the connection, and the reset may overtake the answer.
  channel_->end();
  state_ = State::lingering;
  deadline_ = Clock::now() + owner_.limits().linger;
}

void Connection::drop() {
  channel_->forget_unsent();
  finish();
}

void Connection::finish() {
  if (state_ == State::reading_head) channel_->end();
  state_ = State::finished;
  suspended_.reset();
  writer_.reset();
}

}  // namespace geosis::server::http
