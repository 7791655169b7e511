#include "server/store/blob_trailer.h"

#include <gtest/gtest.h>

#include "tests/server/store/store_bytes.h"

namespace geosis::server {
namespace {

using test::bytes_of;

constexpr std::string_view kPayload = "{\"id\":\"3f\"}";

// Version 1 as it lies on disks: must stay readable.
constexpr unsigned char kStored[] = {'G', 'E', 'O', 'B', 'L',  'O',  'B',  '1',  11,   0,    0,    0,
                                     0,   0,   0,   0,   0xa6, 0x99, 0x4d, 0x19, 0x57, 0xf1, 0x5a, 0x85};

BlobTrailer::Bytes stored() {
  BlobTrailer::Bytes bytes;
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(kStored[i]);
  return bytes;
}

TEST(BlobTrailer, IsWrittenAsItAlwaysWas) {
  EXPECT_EQ(encode_trailer(trailer_of(bytes_of(kPayload))), stored());
}

TEST(BlobTrailer, OfAWholeFileIsRead) {
  const auto trailer = decode_trailer(stored(), 11 + 24);
  ASSERT_TRUE(trailer);
  EXPECT_TRUE(check_payload(bytes_of(kPayload), *trailer));
}

TEST(BlobTrailer, EachFlippedBitIsFound) {
  for (std::size_t bit = 0; bit < 8 * BlobTrailer::kBytes; ++bit) {
    auto bytes = stored();
    bytes[bit / 8] ^= static_cast<std::byte>(1 << (bit % 8));
    const auto trailer = decode_trailer(bytes, 11 + 24);
    EXPECT_FALSE(trailer && check_payload(bytes_of(kPayload), *trailer)) << bit;
  }
}

TEST(BlobTrailer, OfAFileOfAnotherSizeIsRefused) {
  for (const std::uint64_t file_bytes : {0ull, 11ull, 24ull, 34ull, 36ull, ~0ull})
    EXPECT_EQ(decode_trailer(stored(), file_bytes).error().code, ErrorCode::malformed_input) << file_bytes;
}

}  // namespace
}  // namespace geosis::server
