#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include "server/net/descriptor.h"

namespace geosis::server::http {

/// A client that sends exactly the bytes it is told to, and reads what comes. Every wait ends after ten seconds.
class RawClient {
 public:
  /// receive_bytes   size of the socket's receive buffer; 0 = the system's.
  explicit RawClient(std::uint16_t port, int receive_bytes = 0);

  /// False when the peer is gone.
  bool send(std::string_view bytes);
  /// The next answer's head, with its empty line; "" when the connection ends before.
  std::string read_head();
  std::string read_bytes(std::size_t count);
  /// The head and as many bytes as its Content-Length says.
  std::string read_answer();
  /// Everything until the connection ends.
  std::string read_all();
  /// Reads until `text` was seen, or the connection ends; all that was read.
  std::string read_until(std::string_view text);
  /// Whether the peer has hung up; what it said before is dropped.
  bool is_closed_within(std::chrono::milliseconds time);
  void send_no_more();
  void close() { socket_.close(); }

 private:
  bool receive_some();

  Descriptor socket_;
  std::string received_;
};

/// The status of an answer; 0 when it is none.
int status_of(std::string_view answer);
std::string_view body_of(std::string_view answer);
/// The value of a header; "" when it is absent.
std::string header_of(std::string_view answer, std::string_view name);
/// Sends one request on a connection of its own, with "Connection: close", and returns the whole answer.
std::string ask(std::uint16_t port, const std::string& request_line, const std::string& headers = "",
                const std::string& body = "");

}  // namespace geosis::server::http
