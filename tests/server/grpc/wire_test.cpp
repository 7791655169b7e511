#include "server/grpc/messages/wire.h"

#include <random>
#include <string>

#include <geosis/v1/volume.pb.h>
#include <gtest/gtest.h>

namespace geosis::server::rpc {
namespace {

constexpr int kChunk = v1::UploadVolumeRequest::kChunkFieldNumber;

/// A message in slices of at most so many bytes.
grpc::ByteBuffer cut(const std::string& bytes, std::size_t most) {
  Slices slices;
  for (std::size_t at = 0; at < bytes.size(); at += most) slices.emplace_back(bytes.substr(at, most));
  return {slices.data(), slices.size()};
}

std::optional<std::string> only_chunk(const grpc::ByteBuffer& message) {
  const auto slices = only_field(message, kChunk);
  if (!slices) return std::nullopt;
  std::string bytes;
  for (const grpc::Slice& slice : *slices) bytes.append(slice.begin(), slice.end());
  return bytes;
}

std::string message_of(const std::string& bytes) {
  v1::UploadVolumeRequest message;
  message.set_chunk(bytes);
  return message.SerializeAsString();
}

TEST(Wire, FindsChunksThatProtobufWroteHoweverTheyAreCut) {
  std::string bytes;
  for (const std::size_t size : {0, 1, 5, 127, 128, 300, 20'000}) {
    while (bytes.size() < size) bytes += static_cast<char>(bytes.size() * 31);
    const std::string message = message_of(bytes);
    for (const std::size_t most : {1, 2, 3, 7, 16'384, 1 << 20})
      EXPECT_EQ(only_chunk(cut(message, most)), bytes) << size << " bytes in slices of " << most;
  }
}

TEST(Wire, LeavesOtherMessagesToTheParser) {
  const std::string chunk = message_of("abcdef");
  v1::UploadVolumeRequest options;
  options.mutable_options()->set_name("abcdef");
  for (const std::string& other :
       {std::string(), options.SerializeAsString(), chunk + chunk, chunk.substr(0, 5), chunk.substr(0, 1),
        chunk + std::string("\x78\x01"), std::string("\x12\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff", 12)}) {
    EXPECT_FALSE(only_chunk(cut(other, 3))) << testing::PrintToString(other);
  }
}

// Whatever it takes for a chunk, the parser does too.
TEST(Wire, NeverDiffersFromTheParser) {
  const unsigned seed = std::random_device()();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  int taken = 0;
  for (int n = 0; n < 20'000; ++n) {
    std::string bytes(1 + random() % 8, 0);
    for (char& c : bytes) c = static_cast<char>(random() % 3 == 0 ? random() : random() % 9);
    bytes[0] = random() % 2 == 0 ? '\x12' : bytes[0];
    const auto chunk = only_chunk(cut(bytes, 1 + random() % 4));
    if (!chunk) continue;
    ++taken;
    v1::UploadVolumeRequest message;
    ASSERT_TRUE(parse(cut(bytes, 5), message)) << testing::PrintToString(bytes);
    ASSERT_EQ(message.chunk(), *chunk) << testing::PrintToString(bytes);
  }
  EXPECT_GT(taken, 100);
}

}  // namespace
}  // namespace geosis::server::rpc
