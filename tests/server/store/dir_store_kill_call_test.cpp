// Processes are killed before each single system call of every operation of a directory store: what was stored stays
// whole, what was being stored is old or new, nothing is left over, and the operation can be done again.
#include <filesystem>
#include <functional>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "server/store/dir_store.h"
#include "tests/server/store/killing_calls.h"
#include "tests/server/store/store_bytes.h"
#include "tests/server/store/temporary_folder.h"

namespace geosis::server {
namespace {

namespace fs = std::filesystem;
using test::bytes_of;
using test::End;
using test::read_file;
using test::text_of;
using test::write_file;

constexpr const char* kKey = "t/a/b";
constexpr const char* kOther = "t/other";
constexpr int kMostCalls = 300;

using Operation = std::function<bool(BlobStore&)>;

bool put_new(BlobStore& store) {
  return store.put(kKey, bytes_of("new, and longer")).has_value();
}
bool put_if_new(BlobStore& store) {
  const auto now = store.get_versioned(kKey);
  const auto done = store.put_if(kKey, bytes_of("new, and longer"), now ? now->version : "");
  return done && *done;
}
bool commit_new(BlobStore& store) {
  auto file = store.stage();
  if (!file) return false;
  write_file((*file)->path(), "new, and longer");
  return store.commit(*std::move(file), kKey).has_value();
}
bool remove_it(BlobStore& store) {
  return store.remove(kKey).has_value();
}

std::string content(const BlobStore& store) {
  if (const auto bytes = store.get(kKey)) return text_of(*bytes);
  const auto path = store.local_file(kKey);
  return path ? read_file(*path) : "nothing";
}

class DirStoreKillCallTest : public testing::Test {
 protected:
  /// Runs the operation on a store in which `before` was stored, once for each of its calls. Afterwards the content is
  /// what it was or `after`.
  void kill_at_each_call(const std::string& before, const Operation& operation, const std::string& after) {
    int killed = 0, number = 0;
    for (End end = End::killed; end == End::killed; ++number) {
      ASSERT_LT(number, kMostCalls);
      SCOPED_TRACE("killed before call " + std::to_string(number));
      const fs::path root = folder_.path() / std::to_string(number);
      {
        const auto store = open_dir_store(root).value();
        ASSERT_TRUE(store->put(kOther, bytes_of("other")));
        if (before != "nothing") ASSERT_TRUE(store->put(kKey, bytes_of(before)));
      }
      end = test::in_own_process([&] {
        test::KillingCalls calls(number);
        const auto store = open_dir_store(root, calls);
        return store && operation(**store);
      });
      ASSERT_NE(end, End::failed);
      killed += end == End::killed;
      const auto store = open_dir_store(root).value();
      const std::string left = content(*store);
      EXPECT_TRUE(left == before || left == after) << left;
      EXPECT_TRUE(end == End::killed || left == after) << left;
      EXPECT_EQ(text_of(store->get(kOther).value()), "other");
      EXPECT_EQ(std::distance(fs::directory_iterator(root / "staging"), {}), 1);  // this process's own
      EXPECT_TRUE(operation(*store));
      EXPECT_EQ(content(*store), after);
      fs::remove_all(root);
    }
    EXPECT_GT(killed, 15);
  }

  // What a process wrote survives its end on any file system, so one that needs no disk will do.
  static std::string parent() { return fs::exists("/dev/shm") ? "/dev/shm" : testing::TempDir(); }

  test::TemporaryFolder folder_{parent()};
};

TEST_F(DirStoreKillCallTest, ThePutOfANewBlob) {
  kill_at_each_call("nothing", put_new, "new, and longer");
}
TEST_F(DirStoreKillCallTest, ThePutOverAnOldBlob) {
  kill_at_each_call("old", put_new, "new, and longer");
}
TEST_F(DirStoreKillCallTest, TheConditionalPutOfANewBlob) {
  kill_at_each_call("nothing", put_if_new, "new, and longer");
}
TEST_F(DirStoreKillCallTest, TheConditionalPutOverAnOldBlob) {
  kill_at_each_call("old", put_if_new, "new, and longer");
}
TEST_F(DirStoreKillCallTest, TheCommitOfAFile) {
  kill_at_each_call("nothing", commit_new, "new, and longer");
}
TEST_F(DirStoreKillCallTest, TheRemovalOfABlob) {
  kill_at_each_call("old", remove_it, "nothing");
}

// The lock of a killed process is free: nobody waits for the dead.
TEST_F(DirStoreKillCallTest, CountersOfSeveralProcessesThatAreKilledLoseNothing) {
  const fs::path root = folder_.path() / "counter";
  ASSERT_TRUE(open_dir_store(root).value()->put(kKey, bytes_of("0")));
  const auto add_one = [](BlobStore& store) {
    for (;;) {
      const auto now = store.get_versioned(kKey);
      if (!now) return false;
      const auto done = store.put_if(kKey, bytes_of(std::to_string(std::stoi(text_of(now->bytes)) + 1)), now->version);
      if (!done) return false;
      if (*done) return true;
    }
  };
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  std::vector<pid_t> children;
  for (int n = 0; n < 4; ++n) {
    const pid_t child = ::fork();
    if (child == 0) {
      const auto store = open_dir_store(root);
      while (store && add_one(**store) && ::write(ends[1], "+", 1) == 1) {
      }
      ::_exit(1);
    }
    children.push_back(child);
  }
  ::close(ends[1]);
  int acknowledged = 0;
  for (std::size_t n = 0; n < children.size(); ++n) {  // killed one by one, the others going on
    char byte = 0;
    for (int read = 0; read < 10 && ::read(ends[0], &byte, 1) == 1; ++read) ++acknowledged;
    EXPECT_EQ(::kill(children[n], SIGKILL), 0);
    int status = 0;
    EXPECT_EQ(::waitpid(children[n], &status, 0), children[n]);
    EXPECT_TRUE(WIFSIGNALED(status));
  }
  for (char byte = 0; ::read(ends[0], &byte, 1) == 1;) ++acknowledged;
  ::close(ends[0]);
  const int counted = std::stoi(text_of(open_dir_store(root).value()->get(kKey).value()));
  EXPECT_GE(counted, acknowledged);
  EXPECT_LE(counted, acknowledged + 4);  // each may have been killed before it could say so
}

}  // namespace
}  // namespace geosis::server
