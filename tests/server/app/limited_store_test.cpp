#include "server/app/limited_store.h"

#include <thread>

#include <gtest/gtest.h>

#include "server/app/extractions/result_streams.h"
#include "server/store/memory_store.h"
#include "tests/server/app/service_fixture.h"

namespace geosis::server {
namespace {

using namespace std::chrono_literals;
using test::Service;

class LimitedStoreTest : public testing::Test {
 protected:
  std::unique_ptr<LimitedStore> limited(std::uint64_t limit, std::chrono::milliseconds grace = 0ms) {
    return std::make_unique<LimitedStore>(std::move(*open_memory_store()),
                                          LimitedStore::Options{.limit = limit, .grace = grace, .freshness = 0ms});
  }
  static std::vector<std::byte> bytes(std::size_t count) { return std::vector<std::byte>(count, std::byte{1}); }
  static void put_result(BlobStore& store, const std::string& id, std::size_t size) {
    const std::string folder = "t/extractions/" + id;
    ASSERT_TRUE(store.put(folder + "/request.json", bytes(10)));
    ASSERT_TRUE(store.put(folder + "/parts/0.0.drc", bytes(size))) << id;
    ASSERT_TRUE(store.put(folder + "/manifest.json", bytes(10)));
    std::this_thread::sleep_for(2ms);  // later ones are younger
  }
  static Result<void> commit(BlobStore& store, const BlobKey& key, std::size_t size) {
    auto file = *store.stage();
    std::filesystem::resize_file(file->path(), size);
    return store.commit(std::move(file), key);
  }
};

TEST_F(LimitedStoreTest, ResultsThatWereUsedLongestAgoMakeRoom) {
  const auto store = limited(1'000'000);
  put_result(*store, "a", 300'000);
  put_result(*store, "b", 300'000);
  ASSERT_TRUE(commit(*store, "t/volumes/v/fills/2-linear", 200'000));
  std::this_thread::sleep_for(2ms);
  store->touch("t/extractions/a/manifest.json");
  std::this_thread::sleep_for(2ms);
  put_result(*store, "c", 300'000);
  EXPECT_TRUE(store->exists("t/extractions/a/manifest.json").value());
  EXPECT_FALSE(store->exists("t/extractions/b/manifest.json").value());
  EXPECT_FALSE(store->exists("t/extractions/b/parts/0.0.drc").value());
  EXPECT_TRUE(store->exists("t/extractions/b/request.json").value());  // whoever asks gets it computed again
  EXPECT_TRUE(store->exists("t/volumes/v/fills/2-linear").value());
  put_result(*store, "d", 300'000);
  EXPECT_FALSE(store->exists("t/volumes/v/fills/2-linear").value());
}

TEST_F(LimitedStoreTest, VolumesAndTheirGridsNeverGo) {
  const auto store = limited(1'000'000);
  ASSERT_TRUE(commit(*store, "t/volumes/v/data/p.1/bricks", 400'000));
  ASSERT_TRUE(commit(*store, "t/volumes/v/grids/g/nodes-p.2", 200'000));
  put_result(*store, "a", 300'000);
  const auto refused = commit(*store, "t/volumes/w/data/p.2/bricks", 600'000);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::no_space);
  EXPECT_TRUE(store->exists("t/volumes/v/data/p.1/bricks").value());
  EXPECT_TRUE(store->exists("t/volumes/v/grids/g/nodes-p.2").value());
  EXPECT_EQ(store->put("t/extractions/x/parts/0.0.drc", bytes(2'000'000)).error().code, ErrorCode::no_space);
  EXPECT_TRUE(store->put("t/extractions/x/run.json", bytes(100)));  // documents still find a place
}

TEST_F(LimitedStoreTest, WhatIsInUseStaysAndWhatIsNotDoneToo) {
  const auto store = limited(1'000'000, 1min);
  put_result(*store, "a", 500'000);
  EXPECT_FALSE(store->put("t/extractions/b/parts/0.0.drc", bytes(600'000)));
  EXPECT_TRUE(store->exists("t/extractions/a/manifest.json").value());
  const auto other = limited(1'000'000);
  ASSERT_TRUE(other->put("t/extractions/b/parts/0.0.drc", bytes(600'000)));
  EXPECT_FALSE(other->put("t/extractions/c/parts/0.0.drc", bytes(600'000)));
  EXPECT_TRUE(other->exists("t/extractions/b/parts/0.0.drc").value());
}

TEST_F(LimitedStoreTest, AnEvictedResultIsComputedAgainWithTheSameBytes) {
  const auto store = limited(200'000);
  Service service(*store);
  const std::string volume = service.add_ball();
  const auto first = *service.extractions.create(volume, test::ball_request(), Priority::interactive);
  first->wait_for(30s);
  const std::string id = first->identity().id;
  const std::string part = test::read_all(*service.extractions.part(id, 0, 0)->stream);
  std::uint64_t stored = 0;
  const auto blobs = store->inventory("");
  for (const BlobInfo& blob : *blobs) stored += blob.bytes;
  ASSERT_LT(stored, 200'000u);
  ASSERT_TRUE(commit(*store, "default/volumes/" + std::string(64, 'e') + "/data/p.1/bricks", 201'000 - stored));
  ASSERT_FALSE(store->exists("default/extractions/" + id + "/manifest.json").value());
  const auto again = *service.extractions.find(id);
  again->wait_for(30s);
  EXPECT_EQ(test::read_all(*service.extractions.part(id, 0, 0)->stream), part);
}

}  // namespace
}  // namespace geosis::server
