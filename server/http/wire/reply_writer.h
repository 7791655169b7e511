#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "server/http/connections/body_budget.h"
#include "server/http/connections/channel.h"
#include "server/http/routing/exchange.h"
#include "server/http/wire/reply_head.h"

namespace geosis::server::http {

/// One reply on its way into a channel. A stream is pulled 64 KiB at a time, only when the socket took what
/// was pulled before; while it waits for its next bytes no buffer is held. Its destruction destroys the stream.
class ReplyWriter {
 public:
  /// share   of the budget of bodies, which is given back with the writer.
  ReplyWriter(Reply reply, const ReplyForm& form, BodyBudget::Share share = {});
  ReplyWriter(const ReplyWriter&) = delete;  // what is pending points into it
  ReplyWriter& operator=(const ReplyWriter&) = delete;
  ~ReplyWriter();

  enum class Outcome {
    finished,
    blocked,  ///< the socket is full
    waiting,  ///< the stream has nothing yet; its bell will ring
    more,     ///< enough for one turn: others wait
    broken,   ///< the socket or the stream failed; the peer must see an incomplete answer
  };
  Outcome write(Channel& channel);

  /// bell   called from any thread when a stream that waits may go on.
  void on_ready(std::function<void()> bell);
  /// Says a stream's idle text; for one that waits. False when there is none to say.
  bool say_idle_text();
  bool has_stream() const { return stream_ != nullptr; }
  bool closes() const { return closes_; }
  std::uint64_t bytes_written() const { return written_; }
  /// Of the body that was made whole and is kept until it is written.
  std::uint64_t held_bytes() const { return body_.size(); }

 private:
  bool has_pending() const { return !pending_[0].empty() || !pending_[1].empty(); }
  /// Sends some. Nothing = it may go on.
  std::optional<Outcome> send_pending(Channel& channel);
  /// Pulls the stream's next bytes. Nothing = there is something to send, or the stream was finished.
  std::optional<Outcome> refill();
  Result<ByteStream::Pulled> pull(std::size_t room);
  void hold_buffer();
  void frame(std::size_t count);

  BodyBudget::Share share_;
  std::string head_, body_;
  std::shared_ptr<const std::string> shared_;
  std::unique_ptr<ByteStream> stream_;
  std::optional<std::uint64_t> left_;  ///< of a stream of known length; unset = chunked
  std::unique_ptr<char[]> buffer_;     ///< room for a chunk's size, 64 KiB, line ends and the last chunk
  std::array<std::string_view, 2> pending_;
  std::function<void(std::uint64_t, bool)> on_written_;
  std::uint64_t written_ = 0;
  bool is_finished_ = false;
  bool closes_;
};

}  // namespace geosis::server::http
