#include "server/app/derived/grids.h"

#include <cstring>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/volume/brick_file.h"
#include "server/app/volumes/volumes.h"
#include "server/store/dir_store.h"
#include "server/store/memory_store.h"
#include "tests/server/app/service_fixture.h"
#include "tests/server/store/temporary_folder.h"

namespace geosis::server {
namespace {

constexpr GridShape kShape{20, 20, 20};  // of ball_file()
const PositionFormat kDoubles{.is_double = true};

/// Positions of a grid whose samples get longer by `growth` each.
std::vector<std::byte> nodes(double growth, GridShape shape = kShape) {
  std::vector<double> numbers;
  for (int i = 0; i < shape.inlines; ++i)
    for (int j = 0; j < shape.crosslines; ++j)
      for (int k = 0; k < shape.samples; ++k)
        numbers.insert(numbers.end(), {25.0 * i, 12.5 * j, 4.0 * k + growth * k * k});
  std::vector<std::byte> bytes(numbers.size() * sizeof(double));
  std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return bytes;
}

Result<void> always() {
  return {};
}

class GridsTest : public testing::Test {
 protected:
  Result<AddedGrid> add(double growth, const std::function<Result<void>()>& confirm = always) {
    const auto bytes = nodes(growth);
    return grids.add(volume, *memory_source(bytes), kDoubles, confirm, progress);
  }
  std::vector<BlobKey> stored() const { return store->list("default/", "", 100).value(); }

  std::unique_ptr<BlobStore> store = std::move(*open_memory_store());
  Grids grids{*store, "default", 1};
  const VolumeSummary volume{.id = std::string(64, 'a'), .shape = kShape, .geometry = {}, .sample_unit = "m"};
  NoProgress progress;
};

TEST_F(GridsTest, AreKeptOnceAndFoundByOtherServers) {
  const auto first = add(0);
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_TRUE(first->is_new);
  const std::string id = first->document.at("id").get<std::string>();
  EXPECT_FALSE(first->document.contains("file"));
  EXPECT_EQ(first->document.at("links").at("self"), "/v1/volumes/" + volume.id + "/grids/" + id);
  const auto again = add(0);
  ASSERT_TRUE(again);
  EXPECT_FALSE(again->is_new);
  EXPECT_EQ(again->document, first->document);
  EXPECT_EQ(stored().size(), 2u);
  Grids other(*store, "default", 1);
  const auto opened = other.open(volume, id);
  ASSERT_TRUE(opened) << opened.error().message;
  EXPECT_EQ((*opened)->geometry.map({3, 2, 5}), (Vec3d{75, 25, 20}));
  EXPECT_EQ(*other.open(volume, id), *opened);  // it is held
  EXPECT_EQ(other.list(volume.id, 10, "").value().at("grids").size(), 1u);
}

TEST_F(GridsTest, AreListedByPages) {
  for (const double growth : {0.0, 0.5, 1.0}) ASSERT_TRUE(add(growth));
  const auto first = grids.list(volume.id, 2, "");
  ASSERT_TRUE(first);
  EXPECT_EQ(first->at("grids").size(), 2u);
  const auto rest = grids.list(volume.id, 2, first->at("next_page_token").get<std::string>());
  ASSERT_TRUE(rest);
  EXPECT_EQ(rest->at("grids").size(), 1u);
  EXPECT_TRUE(rest->at("next_page_token").is_null());
}

TEST_F(GridsTest, WhatIsRefusedLeavesNothing) {
  const auto refused = add(0, [] { return Result<void>(Error{ErrorCode::invalid_argument, "another digest"}); });
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "another digest");
  const auto small = nodes(0, {3, 3, 3});
  EXPECT_FALSE(grids.add(volume, *memory_source(small), kDoubles, always, progress));
  EXPECT_TRUE(stored().empty());
  EXPECT_EQ(grids.open(volume, std::string(64, 'b')).error().code, ErrorCode::not_found);
  EXPECT_EQ(grids.open(volume, "../x").error().code, ErrorCode::not_found);
  EXPECT_EQ(grids.document("..", std::string(64, 'b')).error().code, ErrorCode::not_found);
}

TEST_F(GridsTest, DamagedOnesAreReportedAndReplacedByTheNextUpload) {
  const std::string id = add(0)->document.at("id").get<std::string>();
  const auto keys = stored();
  const auto file = store->local_file(keys[1]);
  ASSERT_TRUE(file) << keys[1];
  std::fstream(*file, std::ios::in | std::ios::out | std::ios::binary).seekp(2000).put('!');
  int damages = 0;
  store->on_damage([&](const BlobKey&, const std::string&) { ++damages; });
  Grids fresh(*store, "default", 1);
  const auto refused = fresh.open(volume, id);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::internal);
  EXPECT_EQ(refused.error().message, "grid " + id + ": what is stored of it is damaged; upload it again");
  EXPECT_EQ(damages, 1);
  const auto bytes = nodes(0);
  const auto again = fresh.add(volume, *memory_source(bytes), kDoubles, always, progress);
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_TRUE(again->is_new);
  EXPECT_TRUE(fresh.open(volume, id));
  EXPECT_EQ(stored().size(), 2u);
}

TEST_F(GridsTest, AreRemovedOneByOneAndWithTheirVolume) {
  const std::string id = add(0)->document.at("id").get<std::string>();
  ASSERT_TRUE(add(1));
  ASSERT_TRUE(grids.remove(volume.id, id));
  EXPECT_EQ(grids.open(volume, id).error().code, ErrorCode::not_found);
  EXPECT_EQ(grids.remove(volume.id, id).error().code, ErrorCode::not_found);
  EXPECT_EQ(stored().size(), 2u);
  ASSERT_TRUE(grids.remove_all(volume.id));
  EXPECT_TRUE(stored().empty());
}

TEST_F(GridsTest, FilesOfProcessesThatAreGoneAreRemovedUnlessTheyCount) {
  ASSERT_TRUE(add(0));
  const BlobKey folder = stored().front().substr(0, stored().front().rfind('/') + 1);
  const auto left = store->put(folder + "nodes-process-gone.7", std::vector<std::byte>(10));
  ASSERT_TRUE(left);
  EXPECT_EQ(stored().size(), 3u);
  ASSERT_TRUE(grids.collect_garbage_of(volume.id));
  EXPECT_EQ(stored().size(), store->may_be_running("process-gone") ? 3u : 2u);
}

// A damaged volume that is uploaded again has no volume.json for a moment.
TEST(GridsOfVolumes, StayWhileAnotherServerReplacesTheVolume) {
  const geosis::test::TemporaryFolder folder;
  const auto store = std::move(*open_dir_store(folder.path()));
  auto other = std::move(*open_dir_store(folder.path()));
  const std::string id(64, 'a');
  const BlobKey grid = "default/volumes/" + id + "/grids/" + std::string(64, 'b') + "/grid.json";
  const BlobKey upload = "default/volumes/" + id + "/data/" + other->process_name() + ".0/bricks";
  ASSERT_TRUE(store->put(grid, std::vector<std::byte>(10)));
  ASSERT_TRUE(other->put(upload, std::vector<std::byte>(10)));
  Volumes volumes(*store, "default", 1);
  ASSERT_TRUE(volumes.collect_garbage());
  EXPECT_TRUE(store->exists(grid).value());
  ASSERT_TRUE(other->remove(upload));
  ASSERT_TRUE(volumes.collect_garbage());
  EXPECT_FALSE(store->exists(grid).value());
}

TEST_F(GridsTest, TakeCoordinatesFromVolumes) {
  std::vector<float> depths;
  for (int trace = 0; trace < 400; ++trace)
    for (int k = 0; k < 20; ++k) depths.push_back(static_cast<float>(1000 + 5 * k));
  const auto z = make_bricked_volume(kShape, depths);
  const VolumeSummary times{.id = volume.id, .shape = kShape, .geometry = {}, .sample_unit = "ms"};
  const auto grid = grids.place(times, {nullptr, nullptr, z.get()}, progress);
  ASSERT_TRUE(grid) << grid.error().message;
  EXPECT_EQ(grid->document.at("kind"), "volumes");
  EXPECT_EQ(grid->document.at("times"), false);
  const auto x = grids.place(times, {z.get(), nullptr, nullptr}, progress);
  EXPECT_TRUE(!x || x->document.at("times") == true);
}

TEST(ExtractionsOnGrids, GoWithTheirGridAndAreRefusedWithoutIt) {
  const auto store = std::move(*open_memory_store());
  test::Service service(*store);
  const std::string ball = service.add_ball();
  const VolumeSummary summary = (*service.volumes.open(ball))->summary;
  NoProgress progress;
  const auto bytes = nodes(0.1);
  const auto grid = service.volumes.grids().add(summary, *memory_source(bytes), kDoubles, always, progress);
  ASSERT_TRUE(grid) << grid.error().message;
  const std::string id = grid->document.at("id").get<std::string>();
  Json request = test::ball_request();
  request["grid"] = id;
  const auto created = service.extractions.create(ball, request, Priority::interactive);
  ASSERT_TRUE(created) << created.error().message;
  (*created)->wait_for(std::chrono::minutes(1));
  const auto done = (*created)->snapshot();
  ASSERT_TRUE(done.manifest) << done.error->message;
  EXPECT_EQ(done.manifest->at("grid").at("chosen"), "curvilinear");
  EXPECT_EQ(done.manifest->at("grid").at("lattice_step"), 4.0 / 64);
  EXPECT_EQ(done.manifest->at("transform").at(0), 4);
  const auto plain = service.extractions.create(ball, test::ball_request(), Priority::interactive);
  (*plain)->wait_for(std::chrono::minutes(1));
  ASSERT_TRUE(service.extractions.purge_results_on(ball, id));
  EXPECT_EQ(service.extractions.find((*created)->identity().id).error().code, ErrorCode::not_found);
  EXPECT_TRUE(service.extractions.find((*plain)->identity().id));
  ASSERT_TRUE(service.volumes.grids().remove(ball, id));
  const auto refused = service.extractions.create(ball, request, Priority::interactive);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::not_found);
  EXPECT_EQ(refused.error().message, "request /grid: grid " + id + ": there is no such grid");
}

}  // namespace
}  // namespace geosis::server
