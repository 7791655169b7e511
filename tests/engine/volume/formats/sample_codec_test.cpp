#include "engine/volume/formats/sample_codec.h"

#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace geosis {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

float decode_ibm(std::uint32_t stored) {
  std::vector<std::byte> bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::byte>(stored >> shift));
  float value = 0;
  decode_samples(SampleCode::ibm32, true, bytes, {&value, 1});
  return value;
}

/// The definition: (-1)^sign * fraction / 2^24 * 16^(exponent - 64), in arithmetic of its own.
double ibm_by_definition(std::uint32_t stored) {
  const double fraction = std::ldexp(static_cast<double>(stored & 0xffffff), -24);
  const double value = std::ldexp(fraction, 4 * (static_cast<int>(stored >> 24 & 0x7f) - 64));
  return stored >> 31 ? -value : value;
}

TEST(DecodeIbm, KnowsTheTextbookNumbers) {
  EXPECT_EQ(decode_ibm(0x00000000), 0);
  EXPECT_EQ(decode_ibm(0x41100000), 1);
  EXPECT_EQ(decode_ibm(0xc276a000), -118.625f);
  EXPECT_EQ(decode_ibm(0x40800000), 0.5f);
  EXPECT_EQ(decode_ibm(0x46ffffff), 16777215.0f);
  EXPECT_TRUE(std::signbit(decode_ibm(0x80000000)));
}

TEST(DecodeIbm, TakesFractionsThatAreNotNormalised) {
  EXPECT_EQ(decode_ibm(0x42010000), 1);
  EXPECT_EQ(decode_ibm(0x46000001), 1);
}

TEST(DecodeIbm, RoundsTheEndsOfItsRange) {
  EXPECT_EQ(decode_ibm(0x7fffffff), kInfinity);  // 7.2e75
  EXPECT_EQ(decode_ibm(0xffffffff), -kInfinity);
  EXPECT_EQ(decode_ibm(0x00100000), 0);  // 5.4e-79
  EXPECT_EQ(decode_ibm(0x60ffffff), 0x1.fffffep127f);
  EXPECT_EQ(decode_ibm(0x61100000), kInfinity);  // 2^128
}

TEST(DecodeIbm, AgreesWithTheDefinition) {
  constexpr unsigned seed = 5;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  for (int n = 0; n < 20000; ++n) {
    const auto stored = static_cast<std::uint32_t>(random());
    const double expected = ibm_by_definition(stored);
    if (std::fabs(expected) < 3.4e38) {
      EXPECT_EQ(decode_ibm(stored), static_cast<float>(expected)) << stored;
    }
  }
}

TEST(DecodeSamples, ReadsThreeByteIntegers) {
  const std::vector<std::byte> bytes = {std::byte{0xff}, std::byte{0xff}, std::byte{0xfe},
                                        std::byte{0x01}, std::byte{0x02}, std::byte{0x03}};
  std::vector<float> samples(2);
  decode_samples(SampleCode::int24, true, bytes, samples);
  EXPECT_EQ(samples, (std::vector<float>{-2, 0x010203}));
  decode_samples(SampleCode::uint24, true, bytes, samples);
  EXPECT_EQ(samples, (std::vector<float>{0xfffffe, 0x010203}));
  decode_samples(SampleCode::int24, false, bytes, samples);
  EXPECT_EQ(samples, (std::vector<float>{-0x010001, 0x030201}));
}

TEST(DecodeSamples, TurnsDoublesBeyondFloatInfinite) {
  for (const auto& [stored, expected] :
       std::vector<std::pair<double, float>>{{1e300, kInfinity},
                                             {-1e39, -kInfinity},
                                             {3.4028234663852886e38, std::numeric_limits<float>::max()},
                                             {1e-300, 0}}) {
    float value = 7;
    decode_samples(SampleCode::ieee64, false, std::as_bytes(std::span(&stored, 1)), {&value, 1});
    EXPECT_EQ(value, expected);
  }
}

TEST(NullValue, CountsWhatItTakesAway) {
  std::vector<float> samples = {1, -999.25f, kInfinity, std::numeric_limits<float>::quiet_NaN(), 0};
  const SampleCounts counts = NullValue(-999.25, SampleCode::ieee32).clean(samples);
  EXPECT_EQ(counts.missing, 3);
  EXPECT_EQ(counts.infinite, 1);
  EXPECT_FALSE(counts.all_zero);
  EXPECT_EQ(samples[0], 1);
  EXPECT_TRUE(std::isnan(samples[1]) && std::isnan(samples[2]));
  std::vector<float> zeros(4);
  EXPECT_TRUE(NullValue().clean(zeros).all_zero);
}

TEST(NullValue, ForgivesTruncatedIbmNullsOnly) {
  std::vector<float> samples = {1e30f * (1 - 0x1p-21f)};
  EXPECT_EQ(NullValue(1e30, SampleCode::ieee32).clean(samples).missing, 0);
  EXPECT_EQ(NullValue(1e30, SampleCode::ibm32).clean(samples).missing, 1);
}

}  // namespace
}  // namespace geosis
