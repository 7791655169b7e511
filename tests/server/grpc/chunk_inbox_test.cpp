#include "server/grpc/calls/chunk_inbox.h"

#include <array>
#include <atomic>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace geosis::server::rpc {
namespace {

using namespace std::chrono_literals;

ChunkInbox::Options options(std::uint64_t most = 1 << 20, std::chrono::milliseconds window = 100ms) {
  return {.most_bytes = most, .bytes_per_second = 1000, .window = window};
}

Slices chunk(const std::string& bytes) {
  return {grpc::Slice(bytes)};
}

/// All that comes, or the error's code.
std::string read_all(ChunkInbox& inbox, std::size_t piece = 3) {
  std::string all;
  std::vector<std::byte> bytes(piece);
  for (;;) {
    const auto count = inbox.read(bytes);
    if (!count) return name_of(count.error().code);
    if (*count == 0) return all;
    all.append(reinterpret_cast<const char*>(bytes.data()), *count);
  }
}

TEST(ChunkInbox, GivesTheBytesInOrder) {
  int asked = 0;
  ChunkInbox inbox(options(4 << 20), [&] { ++asked; });
  const std::string most(2 << 20, 'x');
  EXPECT_TRUE(inbox.put(chunk("hello ")));
  EXPECT_FALSE(inbox.put(chunk(most)));  // that is enough
  EXPECT_EQ(asked, 0);
  inbox.end();
  EXPECT_EQ(read_all(inbox, 1000), "hello " + most);
  EXPECT_EQ(asked, 1);
}

TEST(ChunkInbox, AsksOnceForEachMessageThatItPutOff) {
  std::atomic<int> owed{0};
  ChunkInbox inbox(options(64 << 20, 1h), [&] { ++owed; });  // however slow this machine is
  std::string got;
  std::thread reader([&] { got = read_all(inbox, 100'000); });
  std::string sent;
  for (int n = 0; n < 60; ++n) {
    const std::string bytes(static_cast<std::size_t>(n % 7) << 18, static_cast<char>('a' + n % 26));
    sent += bytes;
    if (inbox.put(chunk(bytes))) continue;
    while (owed == 0) std::this_thread::yield();
    --owed;
  }
  inbox.end();
  reader.join();
  EXPECT_TRUE(got == sent);
  EXPECT_EQ(owed, 0);
}

TEST(ChunkInbox, BreaksOffAtOnceWhateverIsHere) {
  ChunkInbox inbox(options(), [] {});
  inbox.put(chunk("something"));
  inbox.break_off({ErrorCode::cancelled, "left"});
  inbox.break_off({ErrorCode::internal, "later"});
  inbox.end();
  EXPECT_EQ(read_all(inbox), "cancelled");
  EXPECT_FALSE(inbox.put(chunk("more")));
}

TEST(ChunkInbox, RefusesMoreThanTheLimit) {
  ChunkInbox inbox(options(10), [] {});
  EXPECT_TRUE(inbox.put(chunk("12345")));
  EXPECT_FALSE(inbox.put(chunk("123456")));
  EXPECT_EQ(read_all(inbox), "limit_exceeded");
}

TEST(ChunkInbox, GivesUpSendersThatAreTooSlow) {
  ChunkInbox inbox(options(), [] {});
  inbox.put(chunk("1"));
  EXPECT_EQ(read_all(inbox), "deadline_exceeded");
}

TEST(ChunkInbox, HoldsTheFileAgainstWhatWasStated) {
  const auto outcome = [](const std::string& sha256, std::optional<std::uint64_t> bytes) -> std::string {
    ChunkInbox inbox(options(), [] {});
    inbox.expect(sha256, bytes);
    inbox.put(chunk("abc"));
    inbox.end();
    std::array<std::byte, 2> some{};
    if (const auto count = inbox.read(some); !count) return name_of(count.error().code);
    const auto same = inbox.check();
    return same ? "same" : name_of(same.error().code);
  };
  const std::string abc(
      "\xba\x78\x16\xbf\x8f\x01\xcf\xea\x41\x41\x40\xde\x5d\xae\x22\x23\xb0\x03\x61\xa3\x96\x17\x7a\x9c\xb4\x10\xff\x61"
      "\xf2\x00\x15\xad",
      32);
  EXPECT_EQ(outcome("", std::nullopt), "same");
  EXPECT_EQ(outcome(abc, 3), "same");
  EXPECT_EQ(outcome(std::string(32, 'x'), 3), "invalid_argument");
  EXPECT_EQ(outcome("", 4), "malformed_input");
  EXPECT_EQ(outcome("", 2), "malformed_input");
}

}  // namespace
}  // namespace geosis::server::rpc
