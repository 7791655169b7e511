#include "engine/volume/synthetic_survey.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/digest.h"

namespace geosis {
namespace {

constexpr GridShape kSmall = {40, 50, 40};

std::vector<float> samples_of(const SyntheticSurveyOptions& options) {
  const SyntheticSurvey survey(options);
  std::vector<float> samples(static_cast<std::size_t>(options.shape.count()));
  const std::span<float> all(samples);
  std::size_t trace = 0;
  for (std::int32_t i = 0; i < options.shape.inlines; ++i) {
    for (std::int32_t j = 0; j < options.shape.crosslines; ++j) {
      const auto count = static_cast<std::size_t>(options.shape.samples);
      survey.fill_trace(i, j, all.subspan(count * trace++, count));
    }
  }
  return samples;
}

int missing_traces(const SyntheticSurveyOptions& options) {
  const SyntheticSurvey survey(options);
  int count = 0;
  for (std::int32_t i = 0; i < options.shape.inlines; ++i) {
    for (std::int32_t j = 0; j < options.shape.crosslines; ++j) count += survey.has_trace(i, j) ? 0 : 1;
  }
  return count;
}

TEST(SyntheticSurvey, HasTheSameSamplesOnEveryMachine) {
  const auto samples = samples_of({.shape = kSmall});
  EXPECT_EQ(sha256_hex(std::as_bytes(std::span(samples))),
            "f38874cc372f1254bb7976f61bca7719460dd90e7ab7087b556c448f5ff09c92");
}

TEST(SyntheticSurvey, AnotherSeedIsAnotherSurvey) {
  EXPECT_NE(samples_of({.shape = kSmall, .seed = 1}), samples_of({.shape = kSmall, .seed = 2}));
}

TEST(SyntheticSurvey, ChannelIsBrighterThanAnyReflector) {
  const auto reflectors = samples_of({.shape = kSmall, .kind = SurveyKind::reflectors});
  const auto channel = samples_of({.shape = kSmall});
  EXPECT_LT(std::ranges::max(reflectors), 0.5f);
  EXPECT_GT(std::ranges::min(reflectors), -0.5f);
  EXPECT_GT(std::ranges::count_if(channel, [](float sample) { return sample > 0.55f; }), 1000);
}

TEST(SyntheticSurvey, OutlineAndHolesAreLeftOutAsAsked) {
  EXPECT_EQ(missing_traces({.shape = kSmall, .polygon = false, .holes = false}), 0);
  const int outside = missing_traces({.shape = kSmall, .holes = false});
  const int in_holes = missing_traces({.shape = kSmall, .polygon = false});
  EXPECT_GT(outside, 100);
  EXPECT_GT(in_holes, 10);
  EXPECT_GT(missing_traces({.shape = kSmall}), std::max(outside, in_holes));
}

}  // namespace
}  // namespace geosis
