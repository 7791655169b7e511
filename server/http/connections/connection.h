#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "server/http/connections/channel.h"
#include "server/http/connections/suspended.h"
#include "server/http/limits.h"
#include "server/http/routing/dispatcher.h"
#include "server/http/uploads/body_collector.h"
#include "server/http/uploads/upload_start.h"
#include "server/http/wire/reply_writer.h"
#include "server/net/rate_guard.h"

namespace geosis::server::http {

class Connection;

/// What connections ask of the loop that holds them.
class ConnectionOwner {
 public:
  virtual ~ConnectionOwner() = default;
  virtual const Limits& limits() const = 0;
  virtual const Dispatcher& dispatcher() const = 0;
  /// No further request is taken on any connection.
  virtual bool is_draining() const = 0;
  /// Runs the handler elsewhere; the answer comes by answer(). False = too much to do already.
  virtual bool handle(Connection& connection, Router::Resolved resolved) = 0;
  /// Whether upload() would find a thread just now.
  virtual bool takes_uploads_of(const std::string& peer) const = 0;
  /// The same with a body that is still to be read; until the answer comes the socket belongs to the upload's thread.
  virtual bool upload(Connection& connection, Head head, Router::Resolved resolved, std::string already) = 0;
  /// The rest of a request that was suspended, on a handler's thread.
  virtual void resume(Connection& connection, std::unique_ptr<Suspended> suspended) = 0;
  /// Calls on_bell() of this connection soon; rung from any thread, also when the connection is gone.
  virtual std::function<void()> bell_of(const Connection& connection) = 0;
};

/// One client's connection: its requests are read, handed on and answered strictly one after the other, so pipelined
/// ones keep their order. Lives in the loop's thread and never blocks.
class Connection {
 public:
  using Clock = std::chrono::steady_clock;

  Connection(std::uint64_t id, std::unique_ptr<Channel> channel, std::string peer, ConnectionOwner& owner);

  std::uint64_t id() const { return id_; }
  int socket() const { return channel_->socket(); }
  Channel& channel() { return *channel_; }
  const std::string& peer() const { return peer_; }

  void on_events(std::uint32_t events);
  void on_bell();
  /// Deadlines and rates; called a few times a second.
  void on_tick();
  /// Ends the connection if it is between two requests.
  void on_drain();
  /// Begins to write; what handle() and upload() lead to.
  void answer(std::unique_ptr<ReplyWriter> writer);
  /// Waits for a pending answer.
  void suspend(std::unique_ptr<Suspended> suspended);

  /// The epoll events it waits for; 0 = none, not even failures.
  std::uint32_t interest() const;
  /// Between two requests, with nothing of the next one here. since   when it became so.
  bool is_idle() const { return state_ == State::reading_head && in_.empty(); }
  Clock::time_point idle_since() const { return idle_since_; }
  bool is_finished() const { return state_ == State::finished; }
  bool is_uploading() const { return state_ == State::uploading; }
  /// The request's answer ends the connection.
  bool closes() const { return closes_; }

 private:
  enum class State {
    reading_head,
    reading_body,  ///< of a small request
    starting_upload,
    handling,   ///< a handler's thread is at work
    uploading,  ///< an upload's thread is at work and owns the socket
    suspended,  ///< the answer is pending
    writing,    ///< the socket is full, or others have their turn
    waiting,    ///< the reply's stream has nothing yet
    lingering,  ///< all is said; the peer may still be sending
    finished,
  };

  void receive();
  void advance();
  void read_head();
  void begin_request(Head head);
  void begin_without_body();
  void begin_small_body(const Head& head);
  void begin_upload(Head head);
  void read_upload_start();
  void start_upload();
  void read_body();
  void invite();
  void resume();
  void write();
  void next_request();
  void linger();
  void finish();
  /// Ends it without a word and throws away what the peer has not taken: nothing is kept for one who is too slow.
  void drop();

  void expect(bool is_taken);
  /// An answer before, or instead of, a handler's: the connection closes, for its next bytes are in doubt.
  ///
  /// line   of a head that was refused.
  void refuse(const Refusal& refusal, const RequestLine& line = {});
  /// Bytes of all answers that the peer's system has taken: what its sockets hold here is not its merit.
  std::uint64_t bytes_taken() const;
  /// False when the peer reads too slowly.
  bool judge_rate();

  std::uint64_t id_;
  std::unique_ptr<Channel> channel_;
  std::string peer_;
  ConnectionOwner& owner_;
  State state_ = State::reading_head;
  Clock::time_point deadline_;
  std::string in_;            ///< received, not yet used
  std::size_t searched_ = 0;  ///< bytes of in_ that hold no end of a head
  bool closes_ = false;
  bool is_advancing_ = false;
  bool is_half_closed_ = false;               ///< the peer sends no more
  std::optional<Router::Resolved> resolved_;  ///< of a request whose body is being read
  std::optional<BodyCollector> body_;
  std::optional<UploadStart> upload_;
  std::unique_ptr<Suspended> suspended_;
  std::unique_ptr<ReplyWriter> writer_;
  Clock::time_point idle_since_, quiet_since_;
  std::optional<Clock::time_point> blocked_since_;
  std::uint64_t written_before_ = 0;  ///< by the writers before this one
  std::uint64_t judged_bytes_ = 0;    ///< taken ones that the rate has counted
  RateGuard rate_;
};

}  // namespace geosis::server::http
