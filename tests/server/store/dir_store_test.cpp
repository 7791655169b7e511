#include "server/store/dir_store.h"

#include <fstream>
#include <set>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include "tests/server/store/store_bytes.h"
#include "tests/server/store/temporary_folder.h"

namespace geosis::server {
namespace {

namespace fs = std::filesystem;
using test::bytes_of;
using test::read_file;
using test::text_of;
using test::write_file;

// Writes down what is flushed and renamed, in this order.
class RecordingCalls final : public FileCalls {
 public:
  int fsync(int descriptor) override {
    const fs::path path = fs::read_symlink("/proc/self/fd/" + std::to_string(descriptor));
    const bool is_staged = path.string().find("/staging/") != std::string::npos;
    log += "flush " + (is_staged ? "staged" : path.filename().string()) + "; ";
    return FileCalls::fsync(descriptor);
  }
  int rename(const char* from, const char* to) override {
    const int renamed = FileCalls::rename(from, to);
    if (renamed == 0) log += "rename " + fs::path(to).filename().string() + "; ";
    return renamed;
  }
  std::string log;
};

class DirStoreTest : public testing::Test {
 protected:
  fs::path root() const { return folder_.path() / "deep" / "store"; }
  fs::path object(const char* key) const { return root() / "objects" / key; }
  std::unique_ptr<BlobStore> open() const { return open_dir_store(root()).value(); }
  std::size_t staging_folders() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(root() / "staging"), {}));
  }

  test::TemporaryFolder folder_;
};

TEST_F(DirStoreTest, BlobsSurviveTheStore) {
  ASSERT_TRUE(open()->put("t/a/b", bytes_of("kept")));
  EXPECT_EQ(text_of(open()->get("t/a/b").value()), "kept");
}

TEST_F(DirStoreTest, ABlobIsItsBytesAndATrailer) {
  ASSERT_TRUE(open()->put("t/a", bytes_of("payload")));
  const std::string file = read_file(object("t/a"));
  EXPECT_EQ(file.size(), 7u + 24u);
  EXPECT_EQ(file.substr(0, 15), "payloadGEOBLOB1");
}

TEST_F(DirStoreTest, EachFlippedBitOfABlobIsFound) {
  const auto store = open();
  ASSERT_TRUE(store->put("t/a", bytes_of("payload")));
  const std::string good = read_file(object("t/a"));
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    std::string bad = good;
    bad[bit / 8] = static_cast<char>(bad[bit / 8] ^ (1 << (bit % 8)));
    write_file(object("t/a"), bad);
    const auto got = store->get("t/a");
    ASSERT_FALSE(got) << bit;
    EXPECT_EQ(got.error().code, ErrorCode::internal);
    EXPECT_NE(got.error().message.find("t/a"), std::string::npos) << got.error().message;
  }
}

TEST_F(DirStoreTest, ATruncatedBlobIsFound) {
  const auto store = open();
  ASSERT_TRUE(store->put("t/a", bytes_of("payload")));
  const std::string good = read_file(object("t/a"));
  for (std::size_t size = 0; size < good.size(); ++size) {
    write_file(object("t/a"), good.substr(0, size));
    EXPECT_EQ(store->get("t/a").error().code, ErrorCode::internal) << size;
  }
}

TEST_F(DirStoreTest, PutAndCommitFlushTheFileThenRenameThenFlushTheWayToIt) {
  RecordingCalls calls;
  const auto store = open_dir_store(root(), calls).value();
  calls.log.clear();
  ASSERT_TRUE(store->put("t/a/b", bytes_of("first in its folder")));
  EXPECT_EQ(calls.log, "flush staged; rename b; flush a; flush t; flush objects; ");
  calls.log.clear();
  ASSERT_TRUE(store->commit(store->stage().value(), "t/a/c"));
  EXPECT_EQ(calls.log, "flush staged; rename c; flush a; ");
  calls.log.clear();
  ASSERT_TRUE(store->put("t/d/e", bytes_of("in a new folder of a known one")));
  EXPECT_EQ(calls.log, "flush staged; rename e; flush d; flush t; ");
  calls.log.clear();
  ASSERT_TRUE(store->remove("t/d/e"));
  EXPECT_EQ(calls.log, "flush t; ");
}

TEST_F(DirStoreTest, AFolderThatOthersMadeAgainIsFlushedAsNew) {
  RecordingCalls calls;
  const auto store = open_dir_store(root(), calls).value();
  ASSERT_TRUE(store->put("t/a/b", bytes_of("x")));
  ASSERT_TRUE(open()->remove("t/a/b"));
  ASSERT_TRUE(open()->put("t/a/c", bytes_of("x")));
  calls.log.clear();
  ASSERT_TRUE(store->put("t/a/d", bytes_of("x")));
  EXPECT_EQ(calls.log, "flush staged; rename d; flush a; flush t; flush objects; ");
}

TEST_F(DirStoreTest, AStartRemovesTheStagingOfDeadProcessesOnly) {
  const auto alive = open();
  const auto file = alive->stage().value();
  const fs::path dead = root() / "staging" / "process-dead42";
  fs::create_directory(dead);
  write_file(dead / "0", "half a survey");
  const auto next = open();
  EXPECT_FALSE(fs::exists(dead));
  EXPECT_TRUE(fs::exists(file->path()));
  EXPECT_EQ(staging_folders(), 2u);
}

TEST_F(DirStoreTest, NothingStaysInStaging) {
  auto store = open();
  ASSERT_TRUE(store->put("t/a", bytes_of("a")));
  const auto left = store->stage().value();
  store.reset();
  EXPECT_EQ(staging_folders(), 0u);
}

TEST_F(DirStoreTest, TwoStoresOnOneFolderSeeEachOthersBlobs) {
  const auto first = open();
  const auto second = open();
  ASSERT_TRUE(first->put("t/a/b", bytes_of("one")));
  EXPECT_EQ(text_of(second->get("t/a/b").value()), "one");
  ASSERT_TRUE(second->remove("t/a/b"));
  EXPECT_EQ(first->get("t/a/b").error().code, ErrorCode::not_found);
  ASSERT_TRUE(first->put("t/a/b", bytes_of("two")));  // the folders it knew are gone
  EXPECT_EQ(text_of(second->get("t/a/b").value()), "two");
}

TEST_F(DirStoreTest, WhatIsNoBlobIsNotListed) {
  const auto store = open();
  ASSERT_TRUE(store->put("t/a", bytes_of("a")));
  write_file(root() / "objects" / "t" / "with space", "x");
  fs::create_directories(root() / "objects" / "t" / "empty" / "folders");
  fs::create_symlink("/etc/passwd", root() / "objects" / "t" / "link");
  EXPECT_EQ(store->list("", "", 9).value(), std::vector<BlobKey>{"t/a"});
  EXPECT_EQ(store->children("t/").value(), std::vector<std::string>{"a"});
  EXPECT_FALSE(store->exists("t/link").value());
}

TEST_F(DirStoreTest, ARootWithASlashAtItsEndIsTheSame) {
  ASSERT_TRUE(open()->put("t/a", bytes_of("a")));
  const auto store = open_dir_store(root() / "").value();
  EXPECT_TRUE(store->exists("t/a").value());
}

TEST_F(DirStoreTest, ARootThroughAFileIsRefused) {
  write_file(folder_.path() / "file", "x");
  const auto store = open_dir_store(folder_.path() / "file" / "store");
  ASSERT_FALSE(store);
  EXPECT_NE(store.error().message.find("file"), std::string::npos) << store.error().message;
}

TEST_F(DirStoreTest, OpeningWaitsForAnotherThatOpens) {
  { const auto make_folders = open(); }
  const int turn = ::open((root() / "staging").c_str(), O_RDONLY | O_DIRECTORY);
  ASSERT_EQ(::flock(turn, LOCK_EX), 0);
  std::atomic<bool> is_open = false;
  std::jthread opener([&] {
    const auto store = open();
    is_open = true;
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_FALSE(is_open);
  ::close(turn);
  opener.join();
  EXPECT_TRUE(is_open);
}

}  // namespace
}  // namespace geosis::server
