#pragma once

#include <algorithm>
#include <array>
#include <string_view>

#include "server/http/routing/router.h"
#include "server/http/wire/chunk_decoder.h"
#include "server/http/wire/head_parser.h"

namespace geosis::server::http {

/// An upload before it has a thread: it gets one when enough of its body is here, so that clients who send next to
/// nothing keep none from those who do.
struct UploadStart {
  Head head;
  Router::Resolved resolved;

  enum class State { too_little, enough, broken };
  /// Whether `received`, all of the body that has arrived, is enough; it only grows between two calls.
  State look_at(std::string_view received) {
    constexpr std::size_t kEnough = 32 * 1024;
    if (received.size() >= kEnough) return State::enough;
    if (!head.is_chunked) {
      return received.size() >= head.content_length.value_or(0) ? State::enough : State::too_little;
    }
    std::array<std::byte, 4096> unread;
    while (looked_at < received.size() && !scout.is_finished()) {
      const auto step = scout.decode(received.substr(looked_at), unread);
      if (!step) return State::broken;
      looked_at += step->consumed;
    }
    return scout.is_finished() ? State::enough : State::too_little;
  }

  ChunkDecoder scout = {};  ///< finds the end of a short chunked body
  std::size_t looked_at = 0;
};

}  // namespace geosis::server::http
