#include "server/app/extractions/result_streams.h"

#include <fstream>

#include <gtest/gtest.h>

#include "server/store/memory_store.h"
#include "server/store/piece_sums.h"
#include "tests/server/app/service_fixture.h"

namespace geosis::server {
namespace {

using namespace std::chrono_literals;
using test::read_all;
using test::Service;

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t found = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++found;
  return found;
}

class ResultStreamsTest : public testing::Test {
 protected:
  std::shared_ptr<Extraction> start() {
    return *service.extractions.create(service.add_ball(), test::ball_request(), Priority::interactive);
  }

  std::unique_ptr<BlobStore> store = std::move(*open_memory_store());
  Service service{*store};
};

TEST_F(ResultStreamsTest, LevelsComeCoarsestFirstAndTheManifestLast) {
  const std::string text = read_all(*level_stream(start(), "edge", {}));
  std::size_t last = 0;
  for (int level = 4; level >= 0; --level) {
    const std::size_t at = text.find("X-Geosis-Level: " + std::to_string(level) + "\r\n");
    ASSERT_NE(at, std::string::npos) << level;
    EXPECT_GE(at, last);
    last = at;
  }
  EXPECT_GT(text.find("Content-Type: application/json"), last);
  EXPECT_EQ(count(text, "--edge\r\n"), 6u);
  EXPECT_TRUE(text.ends_with("\r\n--edge--\r\n"));
}

TEST_F(ResultStreamsTest, FinishedOneStreamsTheSameBytes) {
  const auto extraction = start();
  const std::string live = read_all(*level_stream(extraction, "edge", {}));
  EXPECT_EQ(read_all(*level_stream(extraction, "edge", {})), live);
  Service other(*store);
  EXPECT_EQ(read_all(*level_stream(*other.extractions.find(extraction->identity().id), "edge", {})), live);
}

TEST_F(ResultStreamsTest, EventsTellEachLevelOnceAndThenDone) {
  const std::string text = read_all(*event_stream(start(), 0));
  EXPECT_EQ(count(text, "event: level\n"), 5u);
  EXPECT_EQ(count(text, "event: done\n"), 1u);
  EXPECT_EQ(count(text, "id: 6\n"), 1u);
}

TEST_F(ResultStreamsTest, EventsResumeAfterTheLastOneKnown) {
  const auto extraction = start();
  read_all(*event_stream(extraction, 0));
  EXPECT_EQ(count(read_all(*event_stream(extraction, 3)), "event: level\n"), 2u);
  EXPECT_EQ(count(read_all(*event_stream(extraction, 99)), "event: level\n"), 0u);
}

TEST_F(ResultStreamsTest, ReaderWhoLeavesIsNoticed) {
  const auto extraction = start();
  int abandoned = 0;
  {
    const auto stream = level_stream(extraction, "edge", [&] { ++abandoned; });
  }
  EXPECT_EQ(abandoned, 1);
  read_all(*level_stream(extraction, "edge", [&] { ++abandoned; }));
  EXPECT_EQ(abandoned, 1);
}

TEST_F(ResultStreamsTest, BytesAndFilesComeWhole) {
  std::vector<std::byte> bytes(200'000);
  for (std::size_t n = 0; n < bytes.size(); ++n) bytes[n] = static_cast<std::byte>(n * 31);
  const std::string expected(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  EXPECT_EQ(read_all(*bytes_stream(bytes)), expected);
  EXPECT_EQ(read_all(*bytes_stream({})), "");
  EXPECT_FALSE(file_stream("/nonexistent/file", {}, [] {}));
}

TEST_F(ResultStreamsTest, AFileThatIsDamagedAfterItsFirstPieceEndsThere) {
  auto staged = *store->stage();
  std::string content(150'000, 'a');
  const auto write = [&] { std::ofstream(staged->path(), std::ios::binary) << content; };
  write();
  const auto sums = *sums_of_file(staged->path());
  EXPECT_EQ(read_all(**file_stream(staged->path(), sums, [] {})), content);
  content[100'000] = 'b';
  write();
  int reports = 0;
  const std::string got = read_all(**file_stream(staged->path(), sums, [&] { ++reports; }));
  EXPECT_EQ(got, std::string(65'536, 'a') + "{internal}");
  EXPECT_EQ(reports, 1);
}

}  // namespace
}  // namespace geosis::server
