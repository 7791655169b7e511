#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "server/log/log.h"

namespace geosis::server {

/// Where metrics are. Another server of this machine may have it: then this one goes without, and says so.
inline constexpr const char* kDefaultAdmin = "127.0.0.1:9464";

/// Where the gRPC door is.
inline constexpr const char* kDefaultGrpc = "127.0.0.1:8081";

/// How a server is set up: flags, environment and configuration file end up here.
struct ServeOptions {
  std::string listen = "127.0.0.1:8080";
  std::string tls_certificate, tls_key;  ///< files in PEM, for both doors; empty = plain
  std::string grpc = kDefaultGrpc;       ///< empty = no gRPC
  std::string grpc_client_authorities;   ///< file in PEM: who signs gRPC clients' certificates; empty = none asked
  std::filesystem::path store = "geosis-store";
  std::uint64_t store_limit = 0;      ///< bytes that everything kept may take; 0 = as the disk allows
  std::filesystem::path page;         ///< folder of the built page
  std::string admin = kDefaultAdmin;  ///< metrics and probes; empty = nowhere
  std::vector<std::string> auth;      ///< none: anybody may call; api_keys FILE; empty allows loopback alone
  LogFormat log_format = LogFormat::text;
  LogLevel log_level = LogLevel::info;
  std::vector<std::string> cors_origins;
  std::uint64_t max_body_bytes = std::uint64_t{1} << 40;
  std::size_t connections = 4096;           ///< at one time; fewer where the system allows fewer descriptors
  std::size_t connections_per_peer = 1024;  ///< of one address
  std::chrono::seconds patience{10};        ///< for a request's head, and over which minimum rates are judged
  std::chrono::seconds idle{60};            ///< between a connection's requests
  std::uint64_t memory_bytes = 0;           ///< for what computes; 0 = 70 % of what this process may use
  int threads = 1;                          ///< that one extraction may use
  int workers = 2;                          ///< extractions at one time
  int queued = 64;                          ///< extractions that may wait for a worker
  int queued_per_tenant = 48;               ///< of these in the name of one tenant
  std::chrono::seconds longest{3600};       ///< that one extraction may take
  std::chrono::seconds probe_interval{10};  ///< between the gRPC door's questions for its own health
  std::chrono::seconds drain{25};
  std::chrono::seconds drain_delay{0};  ///< before it: not ready, but open, until balancers have seen that
};

/// Serves until SIGTERM or SIGINT, then is not ready for `drain_delay`, lets running answers finish for `drain`, and
/// stops; a second signal ends the process at once, with status 1. Prints "listening on http://HOST:PORT" on stdout
/// when it is ready, and below it "listening on grpc://HOST:PORT".
///
/// errors   invalid_argument: an address that is not loopback without auth; those of store and front.
Result<void> serve(const ServeOptions& options);

}  // namespace geosis::server
