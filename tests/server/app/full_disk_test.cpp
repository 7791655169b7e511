// A store on a file system of a few MB that is full: what does not fit is refused as no_space and leaves nothing, what
// is there stays readable, and with room again all goes on. Needs the right to mount; skipped without.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <sys/mount.h>

#include "server/store/dir_store.h"
#include "tests/server/app/service_fixture.h"
#include "tests/server/store/store_bytes.h"
#include "tests/server/store/temporary_folder.h"

namespace geosis::server {
namespace {

using namespace std::chrono_literals;
using test::Service;

class FullDiskTest : public testing::Test {
 protected:
  void SetUp() override {
    is_mounted = ::mount("geosis-test", folder.path().c_str(), "tmpfs", 0, "size=4m") == 0;
    if (!is_mounted) GTEST_SKIP() << "may not mount";
    store = std::move(*open_dir_store(folder.path() / "store"));
  }
  void TearDown() override {
    store.reset();
    if (is_mounted) ::umount2(folder.path().c_str(), MNT_DETACH);
  }
  /// Fills all but about `left` bytes.
  void fill(std::uintmax_t left) {
    std::ofstream file(folder.path() / "filler", std::ios::binary);
    const auto space = std::filesystem::space(folder.path()).available;
    file << std::string(space > left ? space - left : 0, 'x');
  }
  void empty() { std::filesystem::remove(folder.path() / "filler"); }

  geosis::test::TemporaryFolder folder;
  bool is_mounted = false;
  std::unique_ptr<BlobStore> store;
};

TEST_F(FullDiskTest, AnUploadIsRefusedAndLeavesNothing) {
  Service service(*store);
  const std::string first = service.add_ball(5);
  for (const std::uintmax_t left : {0u, 4096u, 20'000u, 40'000u}) {
    SCOPED_TRACE(left);
    fill(left);
    NoProgress progress;
    std::vector<GridCandidate> none;
    const auto bytes = test::ball_file(7);
    const auto refused = service.volumes.add(*memory_source(bytes), test::ball_options(), progress, none);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::no_space) << refused.error().message;
    EXPECT_EQ(service.volumes.list(10, "")->at("volumes").size(), 1u);
    EXPECT_TRUE(service.volumes.slice(first, SliceAxis::sample, 3));
    empty();
  }
  EXPECT_FALSE(service.add_ball(7).empty());
  ASSERT_TRUE(service.volumes.collect_garbage());
  EXPECT_EQ(store->list("", "", 100)->size(), 6u);
}

TEST_F(FullDiskTest, AnExtractionFailsAndCanBeAskedForAgain) {
  Service service(*store);
  const std::string volume = service.add_ball();
  fill(30'000);
  const auto failed = service.extractions.create(volume, test::ball_request(), Priority::interactive);
  if (failed) {
    (*failed)->wait_for(30s);
    const auto now = (*failed)->snapshot();
    EXPECT_EQ(now.state, JobState::failed);
    ASSERT_TRUE(now.error);
    EXPECT_EQ(now.error->code, ErrorCode::no_space);
  } else {
    EXPECT_EQ(failed.error().code, ErrorCode::no_space);
  }
  EXPECT_TRUE(service.volumes.slice(volume, SliceAxis::sample, 3));
  empty();
  const auto again = service.extractions.create(volume, test::ball_request(), Priority::interactive);
  ASSERT_TRUE(again) << again.error().message;
  (*again)->wait_for(30s);
  EXPECT_EQ((*again)->snapshot().state, JobState::done);
}

}  // namespace
}  // namespace geosis::server
