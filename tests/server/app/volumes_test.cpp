#include "server/app/volumes.h"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "engine/base/digest.h"
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

TEST_F(VolumesTest, WrongDigestIsRefusedAndLeavesNothing) {
  UploadOptions options = ball_options();
  options.digest = std::string(64, '0');
  const auto refused = add(ball_file(5), options);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::invalid_argument);
  EXPECT_TRUE(service.volumes.list(10, "")->at("volumes").empty());
  options.digest = sha256_hex(ball_file(5));
  EXPECT_TRUE(add(ball_file(5), options));
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

}  // namespace
}  // namespace geosis::server
