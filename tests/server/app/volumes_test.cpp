#include "server/app/volumes/volumes.h"

#include <algorithm>
#include <atomic>
#include <fstream>
#include <numeric>
#include <thread>

#include <gtest/gtest.h>

#include "server/store/memory_store.h"
#include "tests/server/app/service_fixture.h"

namespace geosis::server {
namespace {

using test::ball_file;
using test::ball_options;
using test::Service;

class VolumesTest : public testing::Test {
 protected:
  Result<UploadResult> add(const std::vector<std::byte>& bytes, const UploadOptions& options) {
    NoProgress progress;
    return service.volumes.add(*memory_source(bytes), options, progress, candidates);
  }

  std::unique_ptr<BlobStore> store = std::move(*open_memory_store());
  Service service{*store};
  std::vector<GridCandidate> candidates;
};

TEST_F(VolumesTest, AddedVolumeIsListedDocumentedAndReadable) {
  const std::string id = service.add_ball();
  const auto document = service.volumes.document(id);
  ASSERT_TRUE(document) << document.error().message;
  EXPECT_EQ(document->at("dims"), Json({20, 20, 20}));
  EXPECT_EQ(document->at("name"), "ball");
  EXPECT_EQ(document->at("state"), "ready");
  const auto page = service.volumes.list(10, "");
  ASSERT_TRUE(page);
  EXPECT_EQ(page->at("volumes").size(), 1u);
  const auto volume = service.volumes.open(id);
  ASSERT_TRUE(volume);
  EXPECT_EQ((*volume)->samples->shape(), (GridShape{20, 20, 20}));
}

TEST_F(VolumesTest, SameFileIsKeptOnce) {
  const auto first = add(ball_file(5), ball_options()), second = add(ball_file(5), ball_options());
  ASSERT_TRUE(first && second);
  EXPECT_TRUE(first->is_new);
  EXPECT_FALSE(second->is_new);
  EXPECT_EQ(first->document.at("id"), second->document.at("id"));
}

TEST_F(VolumesTest, OtherOptionsMakeAnotherVolume) {
  UploadOptions shifted = ball_options();
  shifted.import.origin = {1, 2, 3};
  const auto plain = add(ball_file(5), ball_options()), moved = add(ball_file(5), shifted);
  ASSERT_TRUE(plain && moved);
  EXPECT_NE(plain->document.at("id"), moved->document.at("id"));
}

TEST_F(VolumesTest, WhatIsNotConfirmedLeavesNothing) {
  UploadOptions options = ball_options();
  options.confirm = []() -> Result<void> { return Error{ErrorCode::invalid_argument, "another digest"}; };
  const auto refused = add(ball_file(5), options);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "another digest");
  EXPECT_TRUE(service.volumes.list(10, "")->at("volumes").empty());
  EXPECT_TRUE(add(ball_file(5), ball_options()));
}

TEST_F(VolumesTest, NonsenseIsRefusedAndLeavesNothing) {
  const std::vector<std::byte> nonsense(5000, std::byte{7});
  const auto refused = add(nonsense, {});
  ASSERT_FALSE(refused);
  EXPECT_TRUE(service.volumes.list(10, "")->at("volumes").empty());
}

TEST_F(VolumesTest, PagesFollowOneAnother) {
  for (const double radius : {3, 4, 5, 6, 7}) service.add_ball(radius);
  std::vector<std::string> seen;
  std::string token;
  for (int pages = 0; pages < 10; ++pages) {
    const auto page = service.volumes.list(2, token);
    ASSERT_TRUE(page);
    for (const Json& volume : page->at("volumes")) seen.push_back(volume.at("id"));
    if (page->at("next_page_token").is_null()) break;
    token = page->at("next_page_token");
  }
  EXPECT_EQ(seen.size(), 5u);
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
}

TEST_F(VolumesTest, NameAndCrsCanBeChangedAndNothingElse) {
  const std::string id = service.add_ball();
  const auto changed = service.volumes.change(id, {{"name", "reservoir"}, {"crs", "EPSG:23031"}});
  ASSERT_TRUE(changed);
  EXPECT_EQ(changed->at("name"), "reservoir");
  EXPECT_EQ(changed->at("crs"), "EPSG:23031");
  EXPECT_TRUE(service.volumes.change(id, {{"crs", nullptr}})->at("crs").is_null());
  EXPECT_EQ(service.volumes.change(id, {{"dims", {1, 2, 3}}}).error().code, ErrorCode::invalid_argument);
  EXPECT_EQ(service.volumes.change(id, {{"name", 3}}).error().code, ErrorCode::invalid_argument);
}

TEST_F(VolumesTest, RemovedVolumeIsGone) {
  const std::string id = service.add_ball();
  ASSERT_TRUE(service.volumes.remove(id));
  EXPECT_EQ(service.volumes.document(id).error().code, ErrorCode::not_found);
  EXPECT_EQ(service.volumes.open(id).error().code, ErrorCode::not_found);
  EXPECT_EQ(service.volumes.remove(id).error().code, ErrorCode::not_found);
}

TEST_F(VolumesTest, IdsThatAreNoneAreNotFound) {
  for (const char* id : {"", "..", "../../etc/passwd", "abc", "ABCDEF"}) {
    EXPECT_EQ(service.volumes.document(id).error().code, ErrorCode::not_found) << id;
    EXPECT_EQ(service.volumes.open(id).error().code, ErrorCode::not_found) << id;
  }
}

TEST_F(VolumesTest, HistogramAndSliceReadTheSamples) {
  const std::string id = service.add_ball();
  NoProgress progress;
  const auto histogram = service.volumes.histogram(id, 16, progress);
  ASSERT_TRUE(histogram);
  EXPECT_EQ(std::accumulate(histogram->counts.begin(), histogram->counts.end(), std::int64_t{0}), 8000);
  const auto slice = service.volumes.slice(id, SliceAxis::sample, 10);
  ASSERT_TRUE(slice);
  EXPECT_EQ(slice->samples.size(), 400u);
  EXPECT_EQ(service.volumes.slice(id, SliceAxis::sample, 20).error().code, ErrorCode::invalid_argument);
}

/// Files below a volume's folder that are not volume.json.
std::size_t data_blobs(const BlobStore& store, const std::string& id) {
  return store.list("default/volumes/" + id + "/data/", "", 100)->size();
}

void flip_a_bit(const std::filesystem::path& path, std::streamoff from_end) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekg(-from_end, std::ios::end);
  const int byte = file.get();
  file.seekp(-from_end, std::ios::end);
  file.put(static_cast<char>(byte ^ 4));
}

TEST_F(VolumesTest, OfEqualUploadsAtOneTimeByTwoServersOneIsKept) {
  Service other(*store);
  std::atomic<int> made{0};
  {
    std::vector<std::jthread> clients;
    for (int n = 0; n < 8; ++n) {
      clients.emplace_back([&, n] {
        NoProgress progress;
        std::vector<GridCandidate> none;
        const auto added =
            (n % 2 ? service : other).volumes.add(*memory_source(ball_file(5)), ball_options(), progress, none);
        ASSERT_TRUE(added) << added.error().message;
        made += added->is_new;
      });
    }
  }
  EXPECT_EQ(made, 1);
  const Json page = *service.volumes.list(10, "");
  ASSERT_EQ(page.at("volumes").size(), 1u);
  EXPECT_EQ(data_blobs(*store, page["volumes"][0]["id"]), 2u);  // of the one upload that counts
}

TEST_F(VolumesTest, ChangesByTwoServersAreAllKept) {
  Service other(*store);
  const std::string id = service.add_ball();
  for (int round = 0; round < 10; ++round) {
    const std::string text = std::to_string(round);
    std::jthread first([&] { EXPECT_TRUE(service.volumes.change(id, {{"name", text}})); });
    std::jthread second([&] { EXPECT_TRUE(other.volumes.change(id, {{"crs", text}})); });
    first.join();
    second.join();
    const Json now = *service.volumes.document(id);
    EXPECT_EQ(now.at("name"), text);
    EXPECT_EQ(now.at("crs"), text);
  }
}

TEST_F(VolumesTest, RemovedByAnotherServerIsGoneHereToo) {
  Service other(*store);
  const std::string id = service.add_ball();
  ASSERT_TRUE(service.volumes.open(id));
  ASSERT_TRUE(other.volumes.remove(id));
  EXPECT_EQ(service.volumes.open(id).error().code, ErrorCode::not_found);
  EXPECT_EQ(service.volumes.change(id, {{"name", "x"}}).error().code, ErrorCode::not_found);
  EXPECT_TRUE(store->list("", "", 10)->empty());
}

TEST_F(VolumesTest, WhatADeadUploadLeftIsCollectedAndNothingElse) {
  const std::string id = service.add_ball();
  const std::string folder = "default/volumes/" + id + "/data/";
  ASSERT_TRUE(store->put(folder + "process-000000.1/sidecar.json", {}));
  ASSERT_TRUE(store->commit(*store->stage(), folder + "process-000000.1/bricks"));
  ASSERT_TRUE(
      store->commit(*store->stage(), "default/volumes/" + std::string(64, 'e') + "/data/process-000000.2/bricks"));
  ASSERT_TRUE(service.volumes.collect_garbage());
  EXPECT_EQ(store->list("default/volumes/", "", 10)->size(), 3u);
  EXPECT_TRUE(service.volumes.open(id));
}

TEST_F(VolumesTest, DamageIsReportedAsOursAndMendedByTheNextUpload) {
  std::vector<std::string> reports;
  store->on_damage([&](const BlobKey& key, const std::string&) { reports.push_back(key); });
  const std::string id = service.add_ball();
  ASSERT_TRUE(service.volumes.slice(id, SliceAxis::sample, 10));  // the brick was found sound
  const auto bricks = store->local_file(store->list("default/volumes/" + id + "/data/", "", 1)->front());
  std::this_thread::sleep_for(std::chrono::milliseconds(20));  // a file system's clock may be that coarse
  flip_a_bit(*bricks, 12345);
  const auto slice = service.volumes.slice(id, SliceAxis::sample, 10);
  ASSERT_FALSE(slice);
  EXPECT_EQ(slice.error().code, ErrorCode::internal) << slice.error().message;
  EXPECT_EQ(reports.size(), 1u);
  service.add_ball();
  EXPECT_TRUE(service.volumes.slice(id, SliceAxis::sample, 10));
  EXPECT_EQ(data_blobs(*store, id), 2u);
}

}  // namespace
}  // namespace geosis::server
