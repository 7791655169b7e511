#include "server/http/wire/chunk_decoder.h"

#include <array>
#include <string>

#include <gtest/gtest.h>

namespace geosis::server::http {
namespace {

struct Decoded {
  bool is_valid = true, is_finished = false;
  std::string body;
  std::size_t consumed = 0;
};

/// Shows the wire in pieces of `piece` bytes, with room for `room` bytes at a time.
Decoded decode(const std::string& wire, std::size_t piece = 1000, std::size_t room = 1000) {
  ChunkDecoder decoder;
  Decoded decoded;
  std::string buffer(room, '\0');
  while (decoded.consumed < wire.size() && !decoder.is_finished()) {
    const auto step = decoder.decode(std::string_view(wire).substr(decoded.consumed, piece),
                                     std::as_writable_bytes(std::span(buffer)));
    if (!step) return {false, false, decoded.body, decoded.consumed};
    decoded.consumed += step->consumed;
    decoded.body.append(buffer, 0, step->produced);
  }
  decoded.is_finished = decoder.is_finished();
  return decoded;
}

TEST(ChunkDecoder, JoinsChunksHoweverTheyArrive) {
  const std::string wire = "5\r\nhello\r\n1\r\n \r\n00A\r\n0123456789\r\n0\r\n\r\nnext";
  for (const std::size_t piece : {1U, 2U, 3U, 7U, 1000U}) {
    for (const std::size_t room : {1U, 4U, 1000U}) {
      const Decoded decoded = decode(wire, piece, room);
      EXPECT_TRUE(decoded.is_finished);
      EXPECT_EQ(decoded.body, "hello 0123456789");
      EXPECT_EQ(wire.substr(decoded.consumed), "next");
    }
  }
}

TEST(ChunkDecoder, SkipsExtensionsAndTrailer) {
  const Decoded decoded = decode("2;a=b;c\r\nhi\r\n0;d\r\nE: f\r\nG: h\r\n\r\n");
  EXPECT_TRUE(decoded.is_finished);
  EXPECT_EQ(decoded.body, "hi");
}

TEST(ChunkDecoder, IsNotFinishedBeforeTheLastLine) {
  for (const char* wire : {"", "0", "0\r\n", "0\r\n\r", "2\r\nhi\r\n", "2\r\nh"}) {
    EXPECT_TRUE(decode(wire).is_valid) << wire;
    EXPECT_FALSE(decode(wire).is_finished) << wire;
  }
}

TEST(ChunkDecoder, RefusesWhatTwoReadersCouldReadDifferently) {
  for (const char* wire :
       {"\r\n", ";a\r\n", "-1\r\n", "+1\r\n", "0x1\r\n", " 1\r\n", "1 \r\n", "1\n", "g\r\n", "1\rx", "1\r\nab\r\n",
        "1\r\na\n", "1\r\na0\r\n", "1;a\nb\r\n", "0\r\nA: b\n\r\n", "1234567890abcdef\r\n"}) {
    EXPECT_FALSE(decode(wire).is_valid) << wire;
    EXPECT_FALSE(decode(wire, 1).is_valid) << wire;
  }
}

TEST(ChunkDecoder, BoundsExtensionsAndTrailerOfTheWholeBody) {
  std::string wire;
  for (int i = 0; i < 100; ++i) wire += "1;" + std::string(100, 'a') + "\r\nb\r\n";
  EXPECT_FALSE(decode(wire).is_valid);
  EXPECT_FALSE(decode("0\r\n" + std::string(10'000, 'a')).is_valid);
}

TEST(ChunkDecoder, StaysBrokenAfterAnError) {
  ChunkDecoder decoder;
  std::array<std::byte, 8> room;
  EXPECT_FALSE(decoder.decode("x", room));
  EXPECT_FALSE(decoder.decode("0\r\n\r\n", room));
}

}  // namespace
}  // namespace geosis::server::http
