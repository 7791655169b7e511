#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "server/http/wire/head_parser.h"

namespace geosis::server::http {

/// What one client may take from the front. Each limit bounds memory, descriptors, threads or time.
struct Limits {
  std::size_t connections = 4096;
  std::size_t connections_per_peer = 1024;  ///< by address (IPv6: its /64); a proxy in front counts as one peer
  HeadLimits head;
  std::size_t small_body_bytes = 64 * 1024;             ///< of requests that are no uploads
  std::uint64_t upload_bytes = std::uint64_t{1} << 36;  ///< 64 GiB
  std::chrono::milliseconds head_deadline{10'000};      ///< from a head's first byte to its last; small bodies alike
  std::chrono::milliseconds idle_timeout{60'000};       ///< between requests
  std::chrono::milliseconds quiet_time{15'000};         ///< after which a stream that waits says its idle text
  std::chrono::milliseconds linger{2'000};              ///< for the peer to read an answer before we hang up
  std::uint64_t bytes_per_second = 1024;                ///< slower readers are dropped
  std::uint64_t upload_bytes_per_second = 16 * 1024;    ///< slower uploads, which hold a thread each
  std::chrono::milliseconds rate_window{10'000};        ///< over which those rates are judged
  std::uint64_t held_bytes = std::uint64_t{256} << 20;  ///< of bodies made whole; more are answered 503
  std::chrono::seconds hold_time{120};                  ///< in which a reader has to take a body made whole
};

}  // namespace geosis::server::http
