#include "engine/structure/grid_file.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <vector>

#include <gtest/gtest.h>
#include <xxhash.h>

#include "tests/engine/volume/scratch_folder.h"

namespace geosis {
namespace {

constexpr GridShape kShape = {2, 3, 5};
constexpr std::size_t kHeaderBytes = 128;

/// Every trace goes on by one as late as it can.
StructuralGrid small_grid() {
  StructuralGrid grid;
  grid.paths = LayerPaths(kShape, 70);
  std::vector<std::int32_t> path(70, 0);
  for (std::int32_t k = 0; k < 5; ++k) path[static_cast<std::size_t>(65 + k)] = k;
  for (std::int32_t i = 0; i < 2; ++i) {
    for (std::int32_t j = 0; j < 3; ++j) grid.paths.set(i, j, path);
  }
  for (int n = 0; n < 2 * 3 * 2; ++n) grid.agreement.push_back(static_cast<std::uint8_t>(20 * n));
  grid.report = {.dips = {.period = 14, .dips = {DipQuantiles{0.1, 1, 2}, DipQuantiles{0.2, 2, 3}}, .warped = true},
                 .unreliable_share = 0.25,
                 .untied_share = 0.01};
  return grid;
}

std::vector<std::byte> small_file() {
  const ScratchFolder folder;
  EXPECT_TRUE(write_grid_file(small_grid(), folder / "grid"));
  std::ifstream in(folder / "grid", std::ios::binary);
  const std::vector<char> text{std::istreambuf_iterator<char>(in), {}};
  std::vector<std::byte> file(text.size());
  std::memcpy(file.data(), text.data(), text.size());
  return file;
}

void correct_checksums(std::vector<std::byte>& file) {
  const auto put = [&](std::size_t at, std::uint64_t value) { std::memcpy(file.data() + at, &value, sizeof value); };
  put(112, XXH3_64bits(file.data() + kHeaderBytes, file.size() - kHeaderBytes));
  put(120, 0);
  put(120, XXH3_64bits(file.data(), kHeaderBytes));
}

TEST(GridFile, GivesTheGridBack) {
  const ScratchFolder folder;
  const StructuralGrid grid = small_grid();
  ASSERT_TRUE(write_grid_file(grid, folder / "grid"));
  const auto read = open_grid_file(kShape, folder / "grid");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->paths.layers(), 70);
  EXPECT_TRUE(std::ranges::equal(read->paths.words(), grid.paths.words()));
  EXPECT_EQ(read->agreement, grid.agreement);
  EXPECT_EQ(read->report, grid.report);
}

TEST(GridFile, HasTheBytesThatItsPageDescribes) {
  const auto file = small_file();
  ASSERT_EQ(file.size(), kHeaderBytes + 6 * 2 * 8 + 12);
  EXPECT_EQ(std::memcmp(file.data(), "GEOLAYER", 8), 0);
  const auto int_at = [&](std::size_t at) {
    std::int32_t value;
    std::memcpy(&value, file.data() + at, sizeof value);
    return value;
  };
  EXPECT_EQ(int_at(8), 1);
  EXPECT_EQ(int_at(12), 2);
  EXPECT_EQ(int_at(16), 3);
  EXPECT_EQ(int_at(20), 5);
  EXPECT_EQ(int_at(24), 70);
  EXPECT_EQ(int_at(28), 1);
  EXPECT_EQ(int_at(kHeaderBytes + 8), 0x1e);  // steps 65, 66, 67, 68
}

TEST(GridFile, IsRefusedWhateverByteIsDamaged) {
  const auto sound = small_file();
  for (std::size_t at = 0; at < sound.size(); ++at) {
    auto damaged = sound;
    damaged[at] ^= std::byte{0x10};
    EXPECT_FALSE(read_grid_file(kShape, damaged)) << at;
  }
  for (std::size_t size = 0; size < sound.size(); size += 7) {
    EXPECT_FALSE(read_grid_file(kShape, std::span(sound).first(size))) << size;
  }
  EXPECT_FALSE(read_grid_file({3, 2, 5}, sound));
}

TEST(GridFile, IsRefusedWhenItsChecksumsAreRightAndItsPathsAreNot) {
  auto file = small_file();
  file[kHeaderBytes] = std::byte{1};  // one step too many
  correct_checksums(file);
  const auto read = read_grid_file(kShape, file);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::malformed_input);
  EXPECT_NE(read.error().message.find("path"), std::string::npos);
  auto tall = small_file();
  tall[27] = std::byte{0x7f};  // layers
  correct_checksums(tall);
  EXPECT_FALSE(read_grid_file(kShape, tall));
  auto odd = small_file();
  std::memset(odd.data() + 32, 0xff, 8);  // the period
  correct_checksums(odd);
  EXPECT_FALSE(read_grid_file(kShape, odd));
}

}  // namespace
}  // namespace geosis
