#include "engine/pipeline/estimate.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "engine/isosurface/estimate_triangles.h"
#include "engine/volume/brick_file.h"
#include "engine/volume/formats/byte_source.h"
#include "engine/volume/formats/import.h"
#include "engine/volume/synthetic_survey.h"
#include "tests/support/shared_data.h"

namespace geosis {
namespace {

constexpr float kOpen = std::numeric_limits<float>::infinity();

template <class Sample>
std::unique_ptr<BrickedVolume> volume_of(GridShape shape, Sample sample) {
  std::vector<float> samples;
  samples.reserve(static_cast<std::size_t>(shape.count()));
  for (int i = 0; i < shape.inlines; ++i)
    for (int j = 0; j < shape.crosslines; ++j)
      for (int k = 0; k < shape.samples; ++k) samples.push_back(sample(i, j, k));
  return make_bricked_volume(shape, samples);
}

ReconstructOptions asking(IsoRange range) {
  ReconstructOptions options;
  options.range = range;
  return options;
}

void expect_within_two(const BrickedVolume& volume, IsoRange range, const std::string& what) {
  ExtractOptions options;
  options.region = whole(volume.shape());
  NoProgress unwatched;
  const auto mesh = extract_body(volume, range, options, unwatched);
  ASSERT_TRUE(mesh) << mesh.error().message;
  const double measured = static_cast<double>(mesh->triangles.size());
  const double estimated = estimate_triangles(volume, range, options);
  EXPECT_GT(estimated, measured / 2) << what << " [" << range.low << ", " << range.high << "]: " << measured;
  EXPECT_LT(estimated, measured * 2) << what << " [" << range.low << ", " << range.high << "]: " << measured;
}

void expect_within_two(const std::filesystem::path& file, const ImportOptions& options, std::vector<IsoRange> ranges) {
  NoProgress unwatched;
  const auto source = open_file(file);
  ASSERT_TRUE(source) << source.error().message;
  const auto volume = import_volume(**source, options, std::nullopt, unwatched, nullptr);
  ASSERT_TRUE(volume) << volume.error().message;
  for (const IsoRange& range : ranges) expect_within_two(*volume->samples, range, file.filename());
}

TEST(EstimateTriangles, IsWithinAFactorOfTwoOnSyntheticSurveys) {
  for (const std::uint64_t seed : {1U, 2U}) {
    const SyntheticSurvey survey({.shape = {100, 120, 130}, .seed = seed, .polygon = false, .holes = false});
    std::vector<float> trace(130);
    const auto volume = volume_of({100, 120, 130}, [&](int i, int j, int k) {
      if (k == 0) survey.fill_trace(i, j, trace);
      return trace[static_cast<std::size_t>(k)];
    });
    for (const IsoRange range : {IsoRange{0.5F, kOpen}, {0.3F, kOpen}, {0.2F, 0.4F}, {-kOpen, -0.2F}, {-0.1F, 0.1F}}) {
      expect_within_two(*volume, range, "seed " + std::to_string(seed));
    }
  }
}

TEST(EstimateTriangles, IsWithinAFactorOfTwoOnASphereInItsBox) {
  const auto sphere = volume_of({90, 90, 90}, [](int i, int j, int k) {
    return std::sqrt(float((i - 45) * (i - 45) + (j - 45) * (j - 45) + (k - 45) * (k - 45)));
  });
  for (const IsoRange range : {IsoRange{-kOpen, 30}, {30, kOpen}, {25, 40}})
    expect_within_two(*sphere, range, "sphere");
}

TEST(EstimateTriangles, IsWithinAFactorOfTwoOnTheSharedVolumes) {
  const auto petrel = shared_file("seismic/petrel_buildup_3d.sgy");
  const auto ketton = shared_file("volumes/ketton_256x256x256_u8.raw.gz");
  const auto bonsai = shared_file("volumes/bonsai_256x256x256_u8.raw.gz");
  if (!std::filesystem::exists(petrel)) GTEST_SKIP() << petrel << " is absent";
  expect_within_two(petrel, {}, {{0.5F, 1.42F}, {0.35F, 1.42F}, {0.3F, 0.6F}, {-0.98F, -0.4F}});
  ImportOptions bytes;
  bytes.format = FileFormat::raw;
  bytes.dims = GridShape{256, 256, 256};
  bytes.dtype = SampleType::uint8;
  bytes.order = RawOrder::inline_fastest;
  const auto unpacked = std::filesystem::temp_directory_path() / ("geosis-estimate-" + std::to_string(getpid()));
  for (const auto& [packed, ranges] :
       {std::pair{ketton, std::vector<IsoRange>{{128, 255}}}, {bonsai, {{40, 255}, {40, 90}, {120, 255}}}}) {
    ASSERT_EQ(std::system(("gzip -dc '" + packed.string() + "' > '" + unpacked.string() + "'").c_str()), 0);
    expect_within_two(unpacked, bytes, ranges);
  }
  std::filesystem::remove(unpacked);
}

TEST(EstimateTriangles, CountsTheCapAndOnlyTheRegion) {
  const auto constant = volume_of({65, 65, 65}, [](int, int, int) { return 1.0F; });
  ExtractOptions options;
  options.region = whole({65, 65, 65});
  EXPECT_DOUBLE_EQ(estimate_triangles(*constant, {0, 2}, options), 6 * 64 * 64 * 2);
  options.region = {{10, 20, 30}, {20, 30, 40}};
  EXPECT_DOUBLE_EQ(estimate_triangles(*constant, {0, 2}, options), 6 * 10 * 10 * 2);
  options.cap = false;
  EXPECT_EQ(estimate_triangles(*constant, {0, 2}, options), 0);
  EXPECT_EQ(estimate_triangles(*constant, {3, 4}, options), 0);
  options.region = {{0, 0, 0}, {65, 1, 1}};
  EXPECT_EQ(estimate_triangles(*constant, {0, 2}, options), 0);
}

TEST(EstimateReconstruction, GrowsWithTheSurfaceAndItsLevels) {
  const auto sphere = volume_of({90, 90, 90}, [](int i, int j, int k) {
    return std::sqrt(float((i - 45) * (i - 45) + (j - 45) * (j - 45) + (k - 45) * (k - 45)));
  });
  const auto small = estimate_reconstruction(*sphere, asking({-kOpen, 15}));
  const auto large = estimate_reconstruction(*sphere, asking({-kOpen, 40}));
  EXPECT_LT(small.triangles, large.triangles);
  EXPECT_LT(small.memory_bytes, large.memory_bytes);
  EXPECT_LT(small.seconds, large.seconds);
  ReconstructOptions finest_only = asking({-kOpen, 40});
  finest_only.levels = by_ratio({1});
  EXPECT_LT(estimate_reconstruction(*sphere, finest_only).bytes, large.bytes);
  ReconstructOptions on_layers = asking({-kOpen, 40});
  on_layers.grid = GridChoice::structural;
  EXPECT_GE(estimate_reconstruction(*sphere, on_layers).memory_bytes, 8U * 90 * 90 * 90);
  EXPECT_GT(estimate_reconstruction(*sphere, on_layers).seconds, large.seconds);
  ReconstructOptions placed = asking({-kOpen, 40});
  placed.grid = GridChoice::curvilinear;
  EXPECT_GT(estimate_reconstruction(*sphere, placed).memory_bytes, large.memory_bytes);
  placed.index_space = true;
  EXPECT_EQ(estimate_reconstruction(*sphere, placed).memory_bytes, large.memory_bytes);
  const auto nothing = estimate_reconstruction(*sphere, asking({1000, kOpen}));
  EXPECT_EQ(nothing.triangles, 0U);
}

}  // namespace
}  // namespace geosis
