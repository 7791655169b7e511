#include "server/store/blob_trailer.h"

#include <algorithm>
#include <string_view>

#include <xxhash.h>

namespace geosis::server {
namespace {

constexpr std::string_view kMagic = "GEOBLOB1";
constexpr std::size_t kLengthAt = 8;
constexpr std::size_t kChecksumAt = 16;

void put_u64(std::uint64_t value, std::byte* at) {
  for (int i = 0; i < 8; ++i) at[i] = static_cast<std::byte>(value >> (8 * i));
}

std::uint64_t get_u64(const std::byte* at) {
  std::uint64_t value = 0;
  for (int i = 0; i < 8; ++i) value |= std::to_integer<std::uint64_t>(at[i]) << (8 * i);
  return value;
}

bool has_magic(const BlobTrailer::Bytes& bytes) {
  return std::equal(kMagic.begin(), kMagic.end(), bytes.begin(),
                    [](char expected, std::byte found) { return static_cast<std::byte>(expected) == found; });
}

}  // namespace

BlobTrailer trailer_of(std::span<const std::byte> payload) {
  return {.length = payload.size(), .checksum = XXH3_64bits(payload.data(), payload.size())};
}

BlobTrailer::Bytes encode_trailer(const BlobTrailer& trailer) {
  BlobTrailer::Bytes bytes;
  std::transform(kMagic.begin(), kMagic.end(), bytes.begin(), [](char c) { return static_cast<std::byte>(c); });
  put_u64(trailer.length, bytes.data() + kLengthAt);
  put_u64(trailer.checksum, bytes.data() + kChecksumAt);
  return bytes;
}

Result<BlobTrailer> decode_trailer(const BlobTrailer::Bytes& bytes, std::uint64_t file_bytes) {
  if (!has_magic(bytes)) return Error{ErrorCode::malformed_input, "no blob trailer at its end"};
  const BlobTrailer trailer{.length = get_u64(bytes.data() + kLengthAt),
                            .checksum = get_u64(bytes.data() + kChecksumAt)};
  if (file_bytes < BlobTrailer::kBytes || trailer.length != file_bytes - BlobTrailer::kBytes) {
    return Error{ErrorCode::malformed_input, "its trailer tells of " + std::to_string(trailer.length) +
                                                 " bytes, the file has " + std::to_string(file_bytes) +
                                                 " with the trailer"};
  }
  return trailer;
}

Result<void> check_payload(std::span<const std::byte> payload, const BlobTrailer& trailer) {
  if (trailer_of(payload).checksum == trailer.checksum) return {};
  return Error{ErrorCode::malformed_input, "its checksum does not match its bytes"};
}

}  // namespace geosis::server
