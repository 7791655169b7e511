#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>

#include "server/net/descriptor.h"

namespace geosis::server::http {

/// A client's non-blocking socket as bytes in and bytes out. This one is plain; TlsContext makes those behind TLS.
///
/// Used by one thread at a time; only interrupt() may be called by another meanwhile.
class Channel {
 public:
  explicit Channel(Descriptor socket) : socket_(std::move(socket)) {}
  Channel(const Channel&) = delete;
  Channel& operator=(const Channel&) = delete;
  virtual ~Channel() = default;

  struct Moved {
    enum class Outcome {
      some,     ///< `count` bytes, at least one
      blocked,  ///< nothing now: wait for read_event() or write_event()
      ended,    ///< the peer sends no more
      broken,
    };
    Outcome outcome = Outcome::blocked;
    std::size_t count = 0;
  };
  virtual Moved receive(std::span<char> into);
  /// Takes from the first piece first.
  virtual Moved send(std::span<const std::string_view> pieces);
  /// Tells the peer that nothing more will be sent.
  virtual void end();

  /// The epoll event after which a receive() or send() that was blocked may go on.
  virtual std::uint32_t read_event() const;
  virtual std::uint32_t write_event() const;
  /// Asks that read_event() comes only when so many bytes are here, or the end: whoever reads much is woken less. A
  /// channel that cannot tell ignores it.
  virtual void wake_at(std::size_t bytes);

  /// Ends both directions at once.
  void interrupt();
  /// Lets the socket's end throw away what the peer has not taken.
  void forget_unsent();
  /// Bytes sent that the peer's system has not taken yet.
  std::uint64_t unsent() const;
  int socket() const { return socket_.number(); }

 private:
  Descriptor socket_;
};

}  // namespace geosis::server::http
