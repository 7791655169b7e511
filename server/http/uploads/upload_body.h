#pragma once

#include <memory>
#include <optional>
#include <string>

#include "server/http/connections/channel.h"
#include "server/http/limits.h"
#include "server/http/routing/exchange.h"
#include "server/http/wire/chunk_decoder.h"
#include "server/net/rate_guard.h"

namespace geosis::server::http {

/// An upload's body, read from its channel by the upload's own thread.
class UploadBody final : public BodyReader {
 public:
  /// already   what arrived together with the head.
  UploadBody(Channel& channel, const Head& head, std::string already, const Limits& limits);

  Result<std::size_t> read(std::span<std::byte> into) override;

 private:
  Result<std::size_t> read_counted(std::span<std::byte> into);
  Result<std::size_t> read_chunked(std::span<std::byte> into);
  Result<std::size_t> decode_buffered(std::span<std::byte> into);
  /// Bytes of the wire, at least one. Waits no longer than the minimum rate allows.
  Result<std::size_t> receive(std::span<std::byte> into);
  Result<void> wait_for_bytes();

  Channel& channel_;
  std::string buffer_;  ///< bytes of the wire that are not decoded yet, from begin_ on
  std::size_t begin_ = 0;
  std::uint64_t left_;  ///< of the stated length, or what the limit still allows of a chunked body
  bool is_chunked_;
  ChunkDecoder decoder_;
  RateGuard rate_;
  std::size_t wake_at_ = 1;     ///< what the channel was asked for
  std::optional<Error> error_;  ///< stays: a body that failed once goes on failing
};

}  // namespace geosis::server::http
