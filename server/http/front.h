#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "engine/base/result.h"
#include "server/http/limits.h"
#include "server/http/routing/cors.h"
#include "server/http/routing/middleware.h"
#include "server/http/routing/router.h"
#include "server/jobs/slots.h"
#include "server/net/tls_certificates.h"

namespace geosis::server::http {

struct FrontOptions {
  std::string listen = "127.0.0.1:8080";    ///< "host:port"; port 0 = any that is free
  TlsCertificates* certificates = nullptr;  ///< outlive the front; null = plain HTTP
  Limits limits = {};
  CorsOptions cors = {};
  std::size_t handler_threads = 8;
  std::size_t queued_requests = 256;  ///< that wait for a handler's thread; more are answered 503
  std::size_t upload_threads = 32;    ///< uploads at one time; more are answered 503
  Slots* uploads = nullptr;           ///< instead: those that other doors take from as well. Outlives the front.
  Middleware* middleware = nullptr;   ///< outlives the front
};

/// The HTTP door: sockets, framing and writing are ours; what a request means is the routes' business.
///
/// One thread holds all connections, idle, reading, writing and waiting for a stream alike: a slow client costs a
/// descriptor and at most 64 KiB, never a thread. Handlers run on a few threads and may block; uploads have a thread
/// each. HTTP/1.1 only, plain or behind TLS; HTTP/2 is a proxy's.
class Front {
 public:
  /// Listens and serves until stop(). errors: invalid_argument (address, certificate), unavailable (port taken, no
  /// descriptors).
  static Result<std::unique_ptr<Front>> start(FrontOptions options, Router routes);
  ~Front();

  std::uint16_t port() const;
  /// Connections that are open now.
  std::size_t connections() const;

  /// Takes no more connections and requests, lets running ones finish. True when all had finished within `grace`.
  bool drain(std::chrono::milliseconds grace);
  /// Breaks what still runs and waits for the handlers that are at work. May be called twice.
  void stop();

 private:
  class Running;
  explicit Front(std::unique_ptr<Running> running);

  std::unique_ptr<Running> running_;
};

}  // namespace geosis::server::http
