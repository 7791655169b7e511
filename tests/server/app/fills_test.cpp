#include "server/app/derived/fills.h"

#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "engine/volume/brick_file.h"
#include "server/store/memory_store.h"

namespace geosis::server {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();
const FillOptions kLinear{.method = FillMethod::linear};

/// 6 x 7 x 8 nodes, value = i, the trace in the middle missing.
std::shared_ptr<const StoredVolume> ramp() {
  constexpr GridShape shape{6, 7, 8};
  std::vector<float> samples;
  for (int i = 0; i < shape.inlines; ++i) {
    for (int j = 0; j < shape.crosslines; ++j) {
      for (int k = 0; k < shape.samples; ++k) samples.push_back(i == 3 && j == 3 ? kMissing : static_cast<float>(i));
    }
  }
  auto volume = std::make_shared<StoredVolume>();
  volume->summary.id = std::string(64, 'a');
  volume->summary.shape = shape;
  volume->samples = make_bricked_volume(shape, samples);
  return volume;
}

class FillsTest : public testing::Test {
 protected:
  std::size_t stored() const { return store->list("default/", "", 100).value().size(); }

  std::unique_ptr<BlobStore> store = std::move(*open_memory_store());
  NoProgress progress;
};

TEST_F(FillsTest, FillsOnceAndRemembers) {
  Fills fills(*store, "default", 1);
  const auto volume = ramp();
  const auto first = fills.fill(volume, kLinear, progress);
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_EQ((*first)->samples->filled_count(), 8);
  EXPECT_EQ((*first)->samples->filled(0)[0].value, 3);
  EXPECT_EQ(*fills.fill(volume, kLinear, progress), *first);
  EXPECT_EQ(stored(), 1u);
}

TEST_F(FillsTest, FindsWhatAnotherServerFilled) {
  const auto volume = ramp();
  ASSERT_TRUE(Fills(*store, "default", 1).fill(volume, kLinear, progress));
  Fills other(*store, "default", 1);
  const auto found = other.fill(volume, kLinear, progress);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ((*found)->samples->filled_count(), 8);
  EXPECT_EQ(stored(), 1u);
}

TEST_F(FillsTest, KeepsWaysOfFillingApart) {
  Fills fills(*store, "default", 1);
  const auto volume = ramp();
  ASSERT_TRUE(fills.fill(volume, kLinear, progress));
  ASSERT_TRUE(fills.fill(volume, {.method = FillMethod::rbf}, progress));
  ASSERT_TRUE(fills.fill(volume, {.method = FillMethod::linear, .max_distance = 1e20}, progress));
  EXPECT_EQ(stored(), 3u);
}

TEST_F(FillsTest, MakesADamagedFileAgain) {
  const auto volume = ramp();
  ASSERT_TRUE(Fills(*store, "default", 1).fill(volume, kLinear, progress));
  const auto path = store->local_file(store->list("default/", "", 1).value().front());
  ASSERT_TRUE(path);
  std::ofstream(*path, std::ios::binary | std::ios::trunc) << "damaged";
  const auto again = Fills(*store, "default", 1).fill(volume, kLinear, progress);
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ((*again)->samples->filled_count(), 8);
}

TEST_F(FillsTest, GoWithTheirVolume) {
  Fills fills(*store, "default", 1);
  const auto volume = ramp();
  ASSERT_TRUE(fills.fill(volume, kLinear, progress));
  ASSERT_TRUE(fills.remove(volume->summary.id));
  EXPECT_EQ(stored(), 0u);
}

TEST_F(FillsTest, ManyWhoAskAtOnceGetOneFill) {
  Fills fills(*store, "default", 1);
  const auto volume = ramp();
  std::vector<std::shared_ptr<const FilledStoredVolume>> got(8);
  {
    std::vector<std::jthread> askers;
    for (auto& mine : got) {
      askers.emplace_back([&] {
        NoProgress unwatched;
        if (auto filled = fills.fill(volume, kLinear, unwatched)) mine = *filled;
      });
    }
  }
  for (const auto& mine : got) EXPECT_EQ(mine, got.front());
  EXPECT_NE(got.front(), nullptr);
}

}  // namespace
}  // namespace geosis::server
