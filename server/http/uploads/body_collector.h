#pragma once

#include <cstdint>
#include <string>

#include "server/http/wire/chunk_decoder.h"
#include "server/http/wire/head_parser.h"

namespace geosis::server::http {

/// Collects the body of a small request, as its bytes arrive, up to a limit.
class BodyCollector {
 public:
  BodyCollector(const Head& head, std::size_t most_bytes);

  enum class State { incomplete, complete, too_big, broken };
  /// Takes what belongs to the body off the front of `wire`.
  State feed(std::string& wire);
  std::string take() { return std::move(body_); }

 private:
  State feed_counted(std::string& wire);
  State feed_chunked(std::string& wire);

  bool is_chunked_;
  std::uint64_t length_;
  std::size_t most_bytes_;
  ChunkDecoder decoder_;
  std::string body_;
};

}  // namespace geosis::server::http
