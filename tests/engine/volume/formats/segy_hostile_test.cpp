// Bytes that lie: every one ends in an error, none in a crash or an unbounded allocation.

#include <random>
#include <string>

#include <gtest/gtest.h>

#include "tests/engine/volume/formats/segy_bytes.h"
#include "tests/engine/volume/scratch_folder.h"

namespace geosis {
namespace {

TEST(HostileSegy, IsRefusedAtEveryLength) {
  const auto bytes = small_survey(3, 3).bytes();
  for (std::size_t size = 0; size < bytes.size(); size += size < 3590 ? 509 : 7) {
    if (size > 3600 && (size - 3600) % 246 == 0) continue;  // whole traces: a smaller survey
    EXPECT_FALSE(import_bytes(std::span(bytes).first(size), {.format = FileFormat::segy})) << size;
  }
}

TEST(HostileSegy, IsRefusedWithHugeSampleCountsAndExtensions) {
  auto file = small_survey(3, 3);
  file.set<std::uint16_t>(3501, 0x200);
  for (const std::uint32_t samples : {0xffffffffu, 0x80000000u, 131072u}) {
    file.set(3269, samples);
    EXPECT_EQ(import_bytes(file.bytes()).error().code, ErrorCode::limit_exceeded) << samples;
  }
  file.set(3269, 0u).set<std::int16_t>(3507, 32767);
  EXPECT_EQ(import_bytes(file.bytes()).error().code, ErrorCode::malformed_input);
  file.set<std::int16_t>(3507, 0).set<std::int32_t>(3529, 0x7fffffff);
  EXPECT_EQ(import_bytes(file.bytes()).error().code, ErrorCode::malformed_input);
}

TEST(HostileSegy, NeverCrashesOnRandomHeaders) {
  for (unsigned seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    auto bytes = small_survey(4, 4).bytes();
    for (int changes = 0; changes < 6; ++changes) {
      const std::size_t at = random() % 2 ? 3200 + random() % 400 : 3600 + random() % (bytes.size() - 3600);
      bytes[at] = static_cast<std::byte>(random());
    }
    const auto volume = import_bytes(bytes);
    EXPECT_TRUE(volume ? volume->description.shape.count() <= 1 << 20 : !volume.error().message.empty());
  }
}

TEST(FailedImport, LeavesNothingBehind) {
  /// Wanted until the brick file is being filled.
  class SoonUnwanted final : public Progress {
   public:
    void report(const char*, double) override { unwanted_ = true; }
    bool cancelled() const override { return unwanted_; }

   private:
    bool unwanted_ = false;
  } progress;
  const ScratchFolder folder;
  const auto bytes = small_survey(3, 3).bytes();
  const auto volume = import_volume(*memory_source(bytes), {}, folder / "volume", progress);
  ASSERT_FALSE(volume);
  EXPECT_EQ(volume.error().code, ErrorCode::cancelled);
  EXPECT_TRUE(folder.is_empty());
}

}  // namespace
}  // namespace geosis
