#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "engine/base/result.h"

namespace geosis::server {

/// The last bytes of a stored blob: what tells a whole one from a damaged one. Layout in docs/formats/blob-file.md.
struct BlobTrailer {
  static constexpr std::size_t kBytes = 24;
  using Bytes = std::array<std::byte, kBytes>;

  std::uint64_t length = 0;    ///< bytes of the payload
  std::uint64_t checksum = 0;  ///< XXH3-64 of the payload
};

BlobTrailer trailer_of(std::span<const std::byte> payload);
BlobTrailer::Bytes encode_trailer(const BlobTrailer& trailer);

/// The trailer at the end of a file of `file_bytes` bytes, before its payload is read or space for it is taken.
///
/// errors   malformed_input: no trailer, or one of another length.
Result<BlobTrailer> decode_trailer(const BlobTrailer::Bytes& bytes, std::uint64_t file_bytes);

/// errors   malformed_input: the payload is not the one that was stored.
Result<void> check_payload(std::span<const std::byte> payload, const BlobTrailer& trailer);

}  // namespace geosis::server
