#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "engine/analysis/body_report.h"
#include "engine/base/progress.h"
#include "engine/isosurface/labelled_surface.h"
#include "engine/volume/formats/byte_source.h"
#include "engine/volume/formats/import.h"
#include "tests/property/surface_laws.h"
#include "tests/support/body_oracle.h"
#include "tests/support/shared_data.h"
#include "tests/support/solid_oracle.h"

// Bodies of real surveys against the oracle.

namespace geosis::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

std::unique_ptr<BrickedVolume> imported(const std::filesystem::path& path) {
  NoProgress progress;
  auto file = open_file(path);
  if (!file) {
    ADD_FAILURE() << file.error().message;
    return nullptr;
  }
  auto volume = import_volume(**file, {}, std::nullopt, progress);
  if (!volume) {
    ADD_FAILURE() << volume.error().message;
    return nullptr;
  }
  return std::move(volume->samples);
}

// All samples of a volume as one field.
ScalarField samples_of(const BrickedVolume& volume) {
  ScalarField field(volume.shape());
  for (std::size_t b = 0; b < volume.brick_count(); ++b) {
    const auto view = volume.brick(b);
    if (!view) {
      ADD_FAILURE() << view.error().message;
      return field;
    }
    for_each_node(view->extent, [&](GridIndex n) {
      const std::size_t at =
          (static_cast<std::size_t>(n.i) * view->extent.crosslines + n.j) * view->extent.samples + n.k;
      field.at({view->first.i + n.i, view->first.j + n.j, view->first.k + n.k}) = view->samples[at];
    });
  }
  return field;
}

void expect_body_of_survey(const char* name, IsoRange range) {
  const std::filesystem::path path = shared_file(name);
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const auto volume = imported(path);
  ASSERT_NE(volume, nullptr);
  const ScalarField field = samples_of(*volume);
  const Verdict verdict = judge_closed_surface(field, range, BodyMode::exact);
  EXPECT_EQ(verdict.broken, "");
  EXPECT_TRUE(verdict.decided);
}

TEST(ExtractBodyOfASurvey, BrightTopsOfTheBuildUp) {
  expect_body_of_survey("seismic/petrel_buildup_3d.sgy", {0.5f, kInf});
}

TEST(ExtractBodyOfASurvey, ShellAroundTheBuildUp) {
  expect_body_of_survey("seismic/petrel_buildup_3d.sgy", {0.3f, 0.6f});
}

// Each body has one outer surface; they are those of the oracle, by their samples.
void expect_bodies_of_survey(const char* name, IsoRange range) {
  const std::filesystem::path path = shared_file(name);
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const auto volume = imported(path);
  ASSERT_NE(volume, nullptr);
  NoProgress progress;
  const auto surface = extract_labelled_body(*volume, range, {.region = whole(volume->shape())}, {}, progress);
  ASSERT_TRUE(surface);
  const SolidOracle solid(samples_of(*volume), range, BodyMode::exact);
  ASSERT_TRUE(solid.decided());
  std::vector<std::int64_t> found, expected = solid.voxels();
  for (const BodySamples& body : surface->samples) found.push_back(body.voxels);
  std::sort(found.begin(), found.end());
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(found, expected);
  const auto reports = report_bodies(surface->mesh, surface->body, surface->samples.size(), AffineGeometry());
  ASSERT_TRUE(reports);
  for (std::size_t body = 0; body < reports->size(); ++body) {
    EXPECT_EQ((*reports)[body].components - (*reports)[body].cavities, 1) << body;
    EXPECT_EQ((*reports)[body].volume_voxels, surface->volume_voxels[body]);
  }
}

TEST(ExtractBodyOfASurvey, BodiesOfTheBuildUp) {
  expect_bodies_of_survey("seismic/petrel_buildup_3d.sgy", {0.5f, kInf});
}

TEST(ExtractBodyOfASurvey, BodiesOfASurveyWithDeadTraces) {
  expect_bodies_of_survey("seismic/f3_crop_missing_traces.sgy", {3500, kInf});
  expect_bodies_of_survey("seismic/f3_crop_missing_traces.sgy", {-2000, 1500});
}

TEST(ExtractBodyOfASurvey, SurveyWithDeadTraces) {
  expect_body_of_survey("seismic/f3_crop_missing_traces.sgy", {3500, kInf});
  expect_body_of_survey("seismic/f3_crop_missing_traces.sgy", {-2000, 1500});
}

}  // namespace
}  // namespace geosis::test
