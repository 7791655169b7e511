#include "server/app/derived/structures.h"

#include <algorithm>
#include <cmath>
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

/// Reflectors that fall by 2 samples a trace.
std::shared_ptr<const StoredVolume> falling() {
  constexpr GridShape shape{12, 10, 60};
  std::vector<float> samples;
  for (int i = 0; i < shape.inlines; ++i) {
    for (int j = 0; j < shape.crosslines; ++j) {
      for (int k = 0; k < shape.samples; ++k) samples.push_back(static_cast<float>(std::sin((k - 2 * i) / 2.5)));
    }
  }
  auto volume = std::make_shared<StoredVolume>();
  volume->summary.id = std::string(64, 'a');
  volume->summary.shape = shape;
  volume->samples = make_bricked_volume(shape, samples);
  return volume;
}

class StructuresTest : public testing::Test {
 protected:
  std::vector<BlobKey> stored() const { return store->list("default/", "", 100).value(); }

  std::unique_ptr<BlobStore> store = std::move(*open_memory_store());
  const std::shared_ptr<const StoredVolume> volume = falling();
  NoProgress progress;
};

TEST_F(StructuresTest, AreMadeOnceAndFoundByOtherServers) {
  Structures structures(*store, "default", 1);
  const auto first = structures.grid(*volume, progress);
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_GE((*first)->paths.layers(), 80);
  EXPECT_EQ(*structures.grid(*volume, progress), *first);
  Structures other(*store, "default", 1);
  const auto found = other.grid(*volume, progress);
  ASSERT_TRUE(found);
  EXPECT_TRUE(std::ranges::equal((*found)->paths.words(), (*first)->paths.words()));
  EXPECT_EQ((*found)->report, (*first)->report);
  const auto dips = structures.dips(*volume, progress);
  ASSERT_TRUE(dips);
  EXPECT_EQ(*dips, (*first)->report.dips);
  EXPECT_EQ(other.dips(*volume, progress).value(), *dips);
  EXPECT_EQ(stored().size(), 2u);
}

TEST_F(StructuresTest, AreMadeAgainWhenDamaged) {
  const auto sound = Structures(*store, "default", 1).grid(*volume, progress);
  ASSERT_TRUE(sound);
  const auto path = store->local_file(stored().front());
  ASSERT_TRUE(path);
  std::ofstream(*path, std::ios::binary | std::ios::trunc) << "damaged";
  int damages = 0;
  store->on_damage([&](const BlobKey&, const std::string&) { ++damages; });
  const auto again = Structures(*store, "default", 1).grid(*volume, progress);
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_TRUE(std::ranges::equal((*again)->paths.words(), (*sound)->paths.words()));
  EXPECT_EQ(damages, 1);
}

TEST_F(StructuresTest, AreMadeAgainWhenTheirDipsMakeNoSense) {
  Structures structures(*store, "default", 1);
  const auto sound = structures.dips(*volume, progress);
  ASSERT_TRUE(sound);
  const std::string nonsense = R"({"period": "long"})";
  ASSERT_TRUE(store->put(stored().front(), std::as_bytes(std::span(nonsense))));
  const auto again = structures.dips(*volume, progress);
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(*again, *sound);
}

TEST_F(StructuresTest, GoWithTheirVolume) {
  Structures structures(*store, "default", 1);
  ASSERT_TRUE(structures.grid(*volume, progress));
  ASSERT_TRUE(structures.dips(*volume, progress));
  ASSERT_TRUE(structures.remove(volume->summary.id));
  EXPECT_TRUE(stored().empty());
  ASSERT_TRUE(structures.grid(*volume, progress));  // and not from memory alone
  EXPECT_EQ(stored().size(), 1u);
}

TEST_F(StructuresTest, ManyWhoAskAtOnceGetOneGrid) {
  Structures structures(*store, "default", 1);
  std::vector<std::shared_ptr<const StructuralGrid>> got(6);
  {
    std::vector<std::jthread> askers;
    for (auto& mine : got) {
      askers.emplace_back([&] {
        NoProgress unwatched;
        if (auto grid = structures.grid(*volume, unwatched)) mine = *grid;
      });
    }
  }
  for (const auto& mine : got) EXPECT_EQ(mine, got.front());
  EXPECT_NE(got.front(), nullptr);
}

}  // namespace
}  // namespace geosis::server
