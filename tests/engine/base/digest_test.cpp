#include "engine/base/digest.h"

#include <array>
#include <cstddef>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "engine/base/hexadecimal.h"

namespace geosis {
namespace {

// FIPS 180-2, appendix B.
constexpr const char* kOfAbc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";

TEST(Digest, IsThatOfTheStandard) {
  EXPECT_EQ(sha256_hex(std::as_bytes(std::span("abc", 3))), kOfAbc);
  Sha256 in_pieces;
  in_pieces.update("a");
  in_pieces.update("");
  in_pieces.update("bc");
  EXPECT_EQ(hexadecimal(std::move(in_pieces).bytes()), kOfAbc);
}

TEST(Hexadecimal, ReadsWhatItWrites) {
  std::array<std::byte, 256> all{}, again{};
  for (std::size_t n = 0; n < all.size(); ++n) all[n] = static_cast<std::byte>(n);
  const std::string text = hexadecimal(all);
  EXPECT_EQ(text.substr(0, 6) + text.substr(506), "000102fdfeff");
  EXPECT_TRUE(is_lower_hexadecimal(text));
  ASSERT_TRUE(read_hexadecimal(text, again));
  EXPECT_EQ(again, all);
}

TEST(Hexadecimal, RefusesWhatIsNone) {
  std::array<std::byte, 2> bytes{};
  EXPECT_TRUE(read_hexadecimal("aB09", bytes));
  EXPECT_EQ(bytes, (std::array<std::byte, 2>{std::byte{0xab}, std::byte{0x09}}));
  EXPECT_FALSE(is_lower_hexadecimal("aB09"));
  for (const char* const text : {"", "ab", "abcde", "abcdef", "abcg", "ab/0", "ab:0", "ab@0", "ab`0"}) {
    EXPECT_FALSE(read_hexadecimal(text, bytes)) << text;
  }
}

}  // namespace
}  // namespace geosis
