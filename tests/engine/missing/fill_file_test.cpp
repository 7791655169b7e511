#include <algorithm>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include <xxhash.h>

#include "engine/missing/file/fill_format.h"
#include "tests/engine/missing/gappy_fields.h"
#include "tests/engine/volume/scratch_folder.h"

namespace geosis {
namespace {

constexpr std::size_t kHeaderBytes = 72;

std::vector<char> read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Two bricks, one filled sample on the layer that they share and one elsewhere.
std::unique_ptr<BrickedVolume> small_volume() {
  test::ScalarField field = test::plane({3, 70, 5}, 1, 2, 3, 4);
  field.at({1, 63, 2}) = test::kMissing;
  field.at({1, 5, 3}) = test::kMissing;
  return test::volume_of(field);
}

void fill_into(const BrickedVolume& volume, const std::filesystem::path& path, int threads) {
  NoProgress unwatched;
  const auto filled = fill_missing(volume, {.method = FillMethod::linear}, path, threads, unwatched);
  ASSERT_TRUE(filled) << filled.error().message;
}

std::vector<char> small_file(const BrickedVolume& volume) {
  const ScratchFolder folder;
  fill_into(volume, folder / "fill", 1);
  return read_file(folder / "fill");
}

bool is_accepted(const BrickedVolume& volume, const std::vector<char>& bytes) {
  return read_fill_file(volume, std::as_bytes(std::span(bytes))).has_value();
}

template <class T>
void put(std::vector<char>& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

template <class T>
T get(const std::vector<char>& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// All checksums put right, as a forger would.
std::vector<char> forged(std::vector<char> bytes, std::size_t bricks) {
  const std::size_t blocks = (128 + bricks * 32 + 63) / 64 * 64, records = 4096;
  for (std::size_t brick = 0; brick < bricks; ++brick) {
    const std::size_t entry = 128 + brick * 32;
    const auto count = get<std::uint32_t>(bytes, entry + 12);
    const auto first = get<std::uint64_t>(bytes, entry + 16);
    if (records + (first + count) * 12 <= bytes.size())
      put(bytes, entry + 24, XXH3_64bits(bytes.data() + records + first * 12, count * 12));
  }
  put(bytes, 56, XXH3_64bits(bytes.data() + 128, blocks + bricks * 512 - 128));
  put(bytes, 64, std::uint64_t{0});
  put(bytes, 64, XXH3_64bits(bytes.data(), kHeaderBytes));
  return bytes;
}

TEST(FillFile, OpensWithWhatWasFilled) {
  const ScratchFolder folder;
  const auto volume = small_volume();
  fill_into(*volume, folder / "fill", 1);
  const auto filled = open_fill_file(*volume, folder / "fill");
  ASSERT_TRUE(filled) << filled.error().message;
  EXPECT_EQ((*filled)->filled_count(), 2);
  ASSERT_EQ((*filled)->filled(0).size(), 2u);
  ASSERT_EQ((*filled)->filled(1).size(), 1u);
  EXPECT_EQ((*filled)->filled(0)[0].place, (64u + 5) * 5 + 3);
  EXPECT_EQ((*filled)->filled(1)[0].value, (*filled)->filled(0)[1].value);
  EXPECT_FALSE((*filled)->summary(0).has_missing);
  EXPECT_FLOAT_EQ(test::samples_of(**filled).at({1, 63, 2}), 1 + 126 + 6 + 4);
}

TEST(FillFile, KeepsTheLayoutThatItsPageDescribes) {
  const auto volume = small_volume();
  const std::vector<char> bytes = small_file(*volume);
  EXPECT_EQ(std::string(bytes.data(), 8), "GEOFILLS");
  EXPECT_EQ(get<std::uint32_t>(bytes, 8), 1u);
  EXPECT_EQ(get<std::int32_t>(bytes, 16), 70);
  EXPECT_EQ(get<std::uint64_t>(bytes, 24), index_checksum(*volume));
  EXPECT_EQ(get<std::uint64_t>(bytes, 32), 2u);  // filled nodes
  EXPECT_EQ(get<std::uint64_t>(bytes, 40), 3u);  // records
  EXPECT_EQ(get<std::uint64_t>(bytes, 48), bytes.size());
  EXPECT_EQ(bytes.size(), 4096u + 3 * 12);
  EXPECT_EQ(get<std::uint32_t>(bytes, 128 + 12), 2u);       // records of brick 0
  EXPECT_EQ(get<std::uint64_t>(bytes, 128 + 32 + 16), 2u);  // before brick 1
  EXPECT_EQ(get<float>(bytes, 192), 4);                     // smallest sample of the first block
  EXPECT_EQ(get<std::uint32_t>(bytes, 4096), (64u + 5) * 5 + 3);
  EXPECT_FLOAT_EQ(get<float>(bytes, 4100), 1 + 10 + 9 + 4);
  EXPECT_EQ(get<std::uint32_t>(bytes, 4104) >> 8, 0u);  // padding
}

TEST(FillFile, RefusesEveryChangedByte) {
  const auto volume = small_volume();
  std::vector<char> bytes = small_file(*volume);
  ASSERT_TRUE(is_accepted(*volume, bytes));
  const std::size_t index_end = 192 + 2 * 512;
  for (std::size_t at = 0; at < bytes.size(); at += at < 192 ? 1 : 7) {
    const bool unclaimed = (at >= kHeaderBytes && at < 128) || (at >= index_end && at < 4096);
    if (unclaimed) continue;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    EXPECT_FALSE(is_accepted(*volume, bytes)) << "byte " << at;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
  }
}

TEST(FillFile, RefusesToBeCutShort) {
  const auto volume = small_volume();
  const std::vector<char> bytes = small_file(*volume);
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{71}, std::size_t{200}, bytes.size() - 1})
    EXPECT_FALSE(is_accepted(*volume, {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)})) << size;
  const ScratchFolder folder;
  EXPECT_EQ(open_fill_file(*volume, folder / "absent").error().code, ErrorCode::not_found);
}

TEST(FillFile, RefusesForgedCountsPlacesAndValues) {
  const auto volume = small_volume();
  const std::vector<char> bytes = small_file(*volume);
  ASSERT_TRUE(is_accepted(*volume, forged(bytes, 2)));  // the forger works
  const auto refuses = [&](std::size_t at, auto value) {
    std::vector<char> changed = bytes;
    put(changed, at, value);
    return !is_accepted(*volume, forged(changed, 2));
  };
  const std::uint64_t huge = ~std::uint64_t{0};
  for (const std::size_t at : {24, 32, 40, 48}) EXPECT_TRUE(refuses(at, huge)) << at;
  EXPECT_TRUE(refuses(40, std::uint64_t{2}));
  EXPECT_TRUE(refuses(128 + 12, std::uint32_t{3}));
  EXPECT_TRUE(refuses(128 + 12, ~std::uint32_t{0}));
  EXPECT_TRUE(refuses(128 + 16, std::uint64_t{1}));
  EXPECT_TRUE(refuses(128 + 32 + 16, huge));
  EXPECT_TRUE(refuses(4096, std::uint32_t{64 * 3 * 5}));  // outside the brick
  EXPECT_TRUE(refuses(4096, std::uint32_t{1 << 20}));
  EXPECT_TRUE(refuses(4108, std::uint32_t{0}));  // places do not rise
  EXPECT_TRUE(refuses(4100, test::kMissing));
  EXPECT_TRUE(refuses(4100, std::numeric_limits<float>::infinity()));
  EXPECT_TRUE(refuses(4104, std::uint32_t{255}));  // as reliable as a measured sample
  EXPECT_TRUE(refuses(4104, std::uint32_t{256}));  // padding
}

TEST(FillFile, RefusesToReplaceAMeasuredSample) {
  const auto volume = small_volume();
  std::vector<char> bytes = small_file(*volume);
  put(bytes, 4096, std::uint32_t{7});
  const ScratchFolder folder;
  bytes = forged(bytes, 2);
  std::ofstream(folder / "fill", std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  const auto filled = open_fill_file(*volume, folder / "fill");
  ASSERT_TRUE(filled) << filled.error().message;
  EXPECT_EQ((*filled)->brick(0).error().code, ErrorCode::malformed_input);
  EXPECT_TRUE((*filled)->brick(1));
}

TEST(FillFile, RefusesAnotherVolume) {
  const auto volume = small_volume();
  const std::vector<char> bytes = small_file(*volume);
  test::ScalarField other = test::samples_of(*volume);
  other.at({0, 0, 0}) -= 1;
  EXPECT_FALSE(is_accepted(*test::volume_of(other), bytes));
}

TEST(FillFile, HasTheSameBytesForAnyNumberOfThreads) {
  test::Random random(23);
  const auto volume = test::volume_of(
      test::with_random_gaps(test::with_holes(test::uniform_noise({130, 30, 70}, random, 0, 1), random, 0.3), random));
  const ScratchFolder folder;
  fill_into(*volume, folder / "1", 1);
  fill_into(*volume, folder / "2", 2);
  fill_into(*volume, folder / "8", 8);
  const std::vector<char> one = read_file(folder / "1");
  EXPECT_TRUE(one == read_file(folder / "2"));
  EXPECT_TRUE(one == read_file(folder / "8"));
}

TEST(FillFile, LeavesNothingBehindWhenCancelled) {
  class Cancelled final : public Progress {
   public:
    void report(const char*, double) override {}
    bool cancelled() const override { return true; }
  } cancelled;
  const auto volume = small_volume();
  const ScratchFolder folder;
  const auto filled = fill_missing(*volume, {.method = FillMethod::linear}, folder / "fill", 1, cancelled);
  ASSERT_FALSE(filled);
  EXPECT_EQ(filled.error().code, ErrorCode::cancelled);
  EXPECT_TRUE(folder.is_empty());
}

}  // namespace
}  // namespace geosis
