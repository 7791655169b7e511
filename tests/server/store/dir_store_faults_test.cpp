// Lets each system call fail in turn: every failure is reported, nothing half is visible, nothing is left over.
#include <algorithm>
#include <cerrno>
#include <functional>
#include <iterator>

#include <gtest/gtest.h>

#include "server/store/dir_store.h"
#include "tests/server/store/store_bytes.h"
#include "tests/server/store/temporary_folder.h"

namespace geosis::server {
namespace {

namespace fs = std::filesystem;
using test::bytes_of;
using test::text_of;
using test::write_file;

// Fails one call, counted from 0, with `reason`; reads and writes in small pieces.
class FailingCalls final : public FileCalls {
 public:
  void fail_call(int number, int reason) {
    count_ = 0;
    failing_ = number;
    reason_ = reason;
  }
  int count() const { return count_; }

  int open(const char* path, int flags, mode_t mode) override {
    return fails() ? -1 : FileCalls::open(path, flags, mode);
  }
  int close(int descriptor) override {
    const bool failed = fails();
    const int closed = FileCalls::close(descriptor);
    return failed ? refuse() : closed;
  }
  ssize_t write(int descriptor, const void* bytes, std::size_t count) override {
    return fails() ? -1 : FileCalls::write(descriptor, bytes, std::min<std::size_t>(count, 5));
  }
  ssize_t pread(int descriptor, void* bytes, std::size_t count, off_t offset) override {
    return fails() ? -1 : FileCalls::pread(descriptor, bytes, std::min<std::size_t>(count, 7), offset);
  }
  int fsync(int descriptor) override { return fails() ? -1 : FileCalls::fsync(descriptor); }
  int flock(int descriptor, int operation) override { return fails() ? -1 : FileCalls::flock(descriptor, operation); }
  int fstat(int descriptor, struct stat* status) override {
    return fails() ? -1 : FileCalls::fstat(descriptor, status);
  }
  int stat(const char* path, struct stat* status) override { return fails() ? -1 : FileCalls::stat(path, status); }
  int lstat(const char* path, struct stat* status) override { return fails() ? -1 : FileCalls::lstat(path, status); }
  int statx(int descriptor, unsigned int mask, struct statx* status) override {
    return fails() ? -1 : FileCalls::statx(descriptor, mask, status);
  }
  int utimens_now(const char* path) override { return fails() ? -1 : FileCalls::utimens_now(path); }
  int rename(const char* from, const char* to) override { return fails() ? -1 : FileCalls::rename(from, to); }
  int unlink(const char* path) override { return fails() ? -1 : FileCalls::unlink(path); }
  int mkdir(const char* path, mode_t mode) override { return fails() ? -1 : FileCalls::mkdir(path, mode); }
  int rmdir(const char* path) override { return fails() ? -1 : FileCalls::rmdir(path); }
  char* mkdtemp(char* pattern) override { return fails() ? nullptr : FileCalls::mkdtemp(pattern); }
  int list_folder(const char* path, std::vector<FolderEntry>& entries) override {
    return fails() ? -1 : FileCalls::list_folder(path, entries);
  }

 private:
  int refuse() const {
    errno = reason_;
    return -1;
  }
  bool fails() {
    if (count_++ != failing_) return false;
    refuse();
    return true;
  }

  int count_ = 0, failing_ = -1, reason_ = EIO;
};

class DirStoreFaultsTest : public testing::Test {
 protected:
  static constexpr const char* kKey = "t/a/b";

  std::unique_ptr<BlobStore> open() { return open_dir_store(root(), calls_).value(); }
  fs::path root() const { return folder_.path() / "store"; }
  std::size_t open_descriptors() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator("/proc/self/fd"), {}));
  }

  // Runs prepare(), then operation() with the n-th of its system calls failing, then check(result), for each n until
  // the operation needs fewer calls.
  void for_each_call(int reason, const std::function<void()>& prepare, const std::function<Result<void>()>& operation,
                     const std::function<void(const Result<void>&)>& check) {
    bool was_reached = true;
    for (int n = 0; was_reached; ++n) {
      SCOPED_TRACE("failing call " + std::to_string(n));
      prepare();
      const std::size_t descriptors = open_descriptors();
      calls_.fail_call(n, reason);
      const auto result = operation();
      was_reached = calls_.count() > n;
      calls_.fail_call(-1, 0);
      EXPECT_EQ(open_descriptors(), descriptors);
      EXPECT_TRUE(result || was_reached);
      check(result);
      ASSERT_LT(n, 200);
    }
  }

  test::TemporaryFolder folder_;
  FailingCalls calls_;
};

TEST_F(DirStoreFaultsTest, APutThatFailsLeavesNothing) {
  const auto store = open();
  for_each_call(
      EIO, [&] { ASSERT_TRUE(store->remove(kKey)); }, [&] { return store->put(kKey, bytes_of("payload")); },
      [&](const Result<void>& done) {
        EXPECT_EQ(store->exists(kKey).value(), done.has_value());
        if (done) return;
        EXPECT_EQ(done.error().code, ErrorCode::unavailable) << done.error().message;
        EXPECT_TRUE(store->children("").value().empty());
      });
}

TEST_F(DirStoreFaultsTest, AReplacementThatFailsLeavesTheOldOrTheNewBlob) {
  const auto store = open();
  for_each_call(
      EIO, [&] { ASSERT_TRUE(store->put(kKey, bytes_of("old"))); },
      [&] { return store->put(kKey, bytes_of("new, and longer")); },
      [&](const Result<void>& done) {
        const std::string left = text_of(store->get(kKey).value());
        EXPECT_TRUE(left == "new, and longer" || (!done && left == "old")) << left;
      });
}

TEST_F(DirStoreFaultsTest, AConditionalPutThatFailsLeavesTheOldOrTheNewBlob) {
  const auto store = open();
  std::string version;
  for_each_call(
      ENOSPC,
      [&] {
        ASSERT_TRUE(store->put(kKey, bytes_of("old")));
        version = store->get_versioned(kKey).value().version;
      },
      [&]() -> Result<void> {
        const auto done = store->put_if(kKey, bytes_of("new, and longer"), version);
        if (!done) return done.error();
        EXPECT_TRUE(*done);
        return {};
      },
      [&](const Result<void>& done) {
        const std::string left = text_of(store->get(kKey).value());
        EXPECT_TRUE(left == "new, and longer" || (!done && left == "old")) << left;
        EXPECT_TRUE(done || done.error().code == ErrorCode::no_space) << done.error().message;
      });
}

TEST_F(DirStoreFaultsTest, AFullDiskIsCalledSo) {
  const auto store = open();
  int refused = 0;
  for_each_call(
      ENOSPC, [&] { ASSERT_TRUE(store->remove(kKey)); }, [&] { return store->put(kKey, bytes_of("payload")); },
      [&](const Result<void>& done) {
        if (done) return;
        ++refused;
        EXPECT_EQ(done.error().code, ErrorCode::no_space) << done.error().message;
      });
  EXPECT_GT(refused, 5);
}

TEST_F(DirStoreFaultsTest, ACommitThatFailsLeavesNothing) {
  const auto store = open();
  std::unique_ptr<StagedFile> file;
  fs::path path;
  for_each_call(
      EIO,
      [&] {
        ASSERT_TRUE(store->remove(kKey));
        file = store->stage().value();
        path = file->path();
        write_file(path, "bricks");
      },
      [&] { return store->commit(std::move(file), kKey); },
      [&](const Result<void>& done) {
        EXPECT_EQ(store->exists(kKey).value(), done.has_value());
        EXPECT_FALSE(fs::exists(path));
      });
}

TEST_F(DirStoreFaultsTest, AReadThatFailsIsReportedAndNotTakenForDamage) {
  const auto store = open();
  const auto read_all = [&]() -> Result<void> {
    if (const auto got = store->get(kKey); !got) return got.error();
    if (const auto listed = store->list("", "", 9); !listed) return listed.error();
    if (const auto names = store->children("t/"); !names) return names.error();
    if (const auto path = store->local_file(kKey); !path) return path.error();
    return {};
  };
  for_each_call(
      EIO, [&] { ASSERT_TRUE(store->put(kKey, bytes_of("payload"))); }, read_all,
      [&](const Result<void>& done) { EXPECT_TRUE(done || done.error().code == ErrorCode::unavailable); });
}

TEST_F(DirStoreFaultsTest, ARemovalThatFailsCanBeRepeated) {
  const auto store = open();
  for_each_call(
      EIO, [&] { ASSERT_TRUE(store->put(kKey, bytes_of("payload"))); }, [&] { return store->remove(kKey); },
      [&](const Result<void>& done) {
        EXPECT_FALSE(done && store->exists(kKey).value());
        EXPECT_TRUE(store->remove(kKey));
        EXPECT_FALSE(store->exists(kKey).value());
      });
}

TEST_F(DirStoreFaultsTest, AnOpeningThatFailsCanBeRepeated) {
  for_each_call(
      EIO, [&] { fs::remove_all(root()); },
      [&]() -> Result<void> {
        const auto store = open_dir_store(root(), calls_);
        if (!store) return store.error();
        return {};
      },
      [&](const Result<void>&) { EXPECT_TRUE(open()->put(kKey, bytes_of("payload"))); });
}

}  // namespace
}  // namespace geosis::server
