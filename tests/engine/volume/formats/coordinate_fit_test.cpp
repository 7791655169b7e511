#include "engine/volume/formats/coordinate_fit.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/engine/volume/formats/segy_bytes.h"

namespace geosis {
namespace {

/// Survey of 6 x 5 traces with coordinates x0 + i * (xi, yi) + j * (xj, yj) in tenths, stored in the given words.
SegyBytes turned_survey(int x_byte, int y_byte, std::int16_t scalar = -10) {
  SegyBytes file(3, 2, 2);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 5; ++j) {
      file.trace().word(189, 100 + i).word(193, 200 + j).word<std::int16_t>(71, scalar);
      file.word(x_byte, 6000000 + 150 * i - 200 * j).word(y_byte, 60000000 + 200 * i + 150 * j);
    }
  return file;
}

TEST(PlaneFit, FindsAnExactPlaneFarFromTheOrigin) {
  PlaneFit fit;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 30; ++j) fit.add(i, j, 6e6 + 12.5 * i - 3 * j, 4e5 - 3.25 * i + 12 * j);
  const auto map = fit.solve();
  ASSERT_TRUE(map);
  EXPECT_NEAR(map->origin.x, 6e6, 1e-6);
  EXPECT_NEAR(map->origin.y, 4e5, 1e-6);
  EXPECT_NEAR(map->step_i.x, 12.5, 1e-9);
  EXPECT_NEAR(map->step_i.y, -3.25, 1e-9);
  EXPECT_NEAR(map->step_j.y, 12, 1e-9);
  EXPECT_NEAR(map->rms, 0, 1e-4);
}

TEST(PlaneFit, NeedsBothDirections) {
  PlaneFit line;
  for (int i = 0; i < 20; ++i) line.add(i, 2 * i, i, i);
  EXPECT_FALSE(line.solve());
}

TEST(Coordinates, GiveTheWorldOfATurnedSurvey) {
  for (const auto& [x_byte, y_byte] : {std::pair{181, 185}, {73, 77}}) {
    const auto volume = import_bytes(turned_survey(x_byte, y_byte).bytes());
    ASSERT_TRUE(volume) << volume.error().message;
    EXPECT_EQ(volume->description.options.x_byte, x_byte);
    const Vec3d p = volume->description.geometry.map({2, 1, 1});
    EXPECT_NEAR(p.x, 600000 + 30 - 20, 1e-6);
    EXPECT_NEAR(p.y, 6000000 + 40 + 15, 1e-6);
    EXPECT_EQ(p.z, 4);
  }
}

TEST(Coordinates, TakeTheScalarFromTheOptions) {
  const auto volume = import_bytes(turned_survey(181, 185, 0).bytes(), {.coordinate_scalar = -100});
  ASSERT_TRUE(volume) << volume.error().message;
  EXPECT_NEAR(volume->description.geometry.map({0, 0, 0}).x, 60000, 1e-6);
  EXPECT_EQ(import_bytes(turned_survey(181, 185).bytes(), {.coordinate_scalar = 0}).error().code,
            ErrorCode::invalid_argument);
}

TEST(Coordinates, OfMirroredSurveysGiveAMirroredWorld) {
  const auto plain = import_bytes(turned_survey(181, 185).bytes());
  const auto mirrored = import_bytes(turned_survey(185, 181).bytes());
  ASSERT_TRUE(plain && mirrored);
  EXPECT_NE(plain->description.geometry.mirrored(), mirrored->description.geometry.mirrored());
}

TEST(Coordinates, ThatDoNotFitTheGridAreNotBelieved) {
  SegyBytes file(3, 2, 2);
  for (int t = 0; t < 30; ++t)
    file.trace()
        .word(189, 100 + 2 * (t / 5))
        .word(193, 200 + t % 5)
        .word(181, t * 7919 % 1000)
        .word(185, t * 104729 % 1000);
  const auto volume = import_bytes(file.bytes());
  ASSERT_TRUE(volume) << volume.error().message;
  EXPECT_EQ(volume->description.warnings.front().code, "no_coordinates");
  EXPECT_EQ(volume->description.geometry.map({1, 1, 0}), (Vec3d{102, 201, 0}));
}

TEST(Coordinates, ThatRepeatTheSurveyNumbersAreNotBelieved) {
  SegyBytes file(3, 2, 2);
  for (int t = 0; t < 30; ++t)
    file.trace().word(189, 100 + t / 5).word(193, 200 + t % 5).word(181, 100 + t / 5).word(185, 200 + t % 5);
  const auto volume = import_bytes(file.bytes());
  ASSERT_TRUE(volume) << volume.error().message;
  EXPECT_NE(volume->description.warnings.front().detail.find("hold the survey numbers"), std::string::npos);
}

}  // namespace
}  // namespace geosis
