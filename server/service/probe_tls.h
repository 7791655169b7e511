#pragma once

#include <memory>
#include <string>

#include "engine/base/result.h"

namespace geosis::server {

/// Whose certificates a client believes.
struct ProbeTrust {
  std::string authorities;       ///< file in PEM, instead of the system's; empty = the system's
  bool any_certificate = false;  ///< asks nobody who the server is
};

/// A client's TLS session over a connected, blocking socket, which outlives it.
class ProbeTls {
 public:
  /// host     the name or address that the certificate must be for.
  /// errors   invalid_argument: authorities that cannot be read. unavailable: no handshake, or a certificate
  ///          that is not to be believed; says why.
  static Result<ProbeTls> begin(int socket, const std::string& host, const ProbeTrust& trust);
  ProbeTls(ProbeTls&&) noexcept;
  ~ProbeTls();

  bool send(const std::string& text);
  /// Bytes read; 0 at the end, -1 when there are none in time.
  long receive(char* into, std::size_t capacity);

 private:
  struct Session;
  explicit ProbeTls(std::unique_ptr<Session> session);
  std::unique_ptr<Session> session_;
};

}  // namespace geosis::server
