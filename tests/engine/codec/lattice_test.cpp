// The lattice must survive Draco's quantisation exactly, for every bit count and every value.

#include <cstdint>
#include <limits>
#include <vector>

#include <draco/attributes/attribute_quantization_transform.h>
#include <draco/attributes/point_attribute.h>
#include <gtest/gtest.h>

#include "engine/codec/level_codec.h"

namespace geosis {
namespace {

/// Values through the quantisation that encode_level asks for and back, by Draco's own code for both ways.
std::vector<float> through_draco(const std::vector<float>& values, int bits) {
  draco::GeometryAttribute form;
  form.Init(draco::GeometryAttribute::POSITION, nullptr, 1, draco::DT_FLOAT32, false, sizeof(float), 0);
  draco::PointAttribute input(form), quantised, output(form);
  input.Reset(values.size());
  input.SetIdentityMapping();
  input.buffer()->Write(0, values.data(), values.size() * sizeof(float));

  form.Init(draco::GeometryAttribute::POSITION, nullptr, 1, draco::DT_UINT32, false, sizeof(std::uint32_t), 0);
  quantised = draco::PointAttribute(form);
  quantised.Reset(values.size());
  quantised.SetIdentityMapping();
  output.Reset(values.size());
  output.SetIdentityMapping();

  const float origin = 0;
  draco::AttributeQuantizationTransform transform;
  EXPECT_TRUE(transform.SetParameters(bits, &origin, 1, static_cast<float>((1 << bits) - 1) * kLatticeStep));
  EXPECT_TRUE(transform.TransformAttribute(input, {}, &quantised));
  EXPECT_TRUE(transform.InverseTransformAttribute(quantised, &output));
  std::vector<float> result(values.size());
  output.buffer()->Read(0, result.data(), result.size() * sizeof(float));
  return result;
}

class LatticeOfBits : public testing::TestWithParam<int> {};

TEST_P(LatticeOfBits, EveryPositionSurvivesQuantisation) {
  std::vector<float> positions(std::size_t{1} << GetParam());
  for (std::size_t step = 0; step < positions.size(); ++step) positions[step] = static_cast<float>(step) * kLatticeStep;
  EXPECT_TRUE(through_draco(positions, GetParam()) == positions);
}

INSTANTIATE_TEST_SUITE_P(All, LatticeOfBits, testing::Range(7, kMaxPositionBits + 1));

TEST(Lattice, OneBitMoreWouldNotSurvive) {
  const float odd_step_beyond_2_23 = static_cast<float>((1 << 23) + 1) * kLatticeStep;
  EXPECT_NE(through_draco({odd_step_beyond_2_23}, kMaxPositionBits + 1)[0], odd_step_beyond_2_23);
}

TEST(PositionBitsFor, HoldsTheLastNodeAndNoMoreThanNeeded) {
  for (std::int32_t samples = 2; samples <= 131'072; ++samples) {
    const std::int64_t last_step = std::int64_t{samples - 1} * kLatticeStepsPerVoxel;
    const int bits = position_bits_for(samples);
    ASSERT_LE(last_step, (std::int64_t{1} << bits) - 1) << samples;
    ASSERT_GT(last_step, (std::int64_t{1} << (bits - 1)) - 1) << samples;
  }
  EXPECT_EQ(position_bits_for(256), 14);
  EXPECT_EQ(position_bits_for(257), 15);
  EXPECT_EQ(position_bits_for(131'072), kMaxPositionBits);
}

TEST(PositionBitsFor, AnswersForAnyNumberOfSamples) {
  EXPECT_EQ(position_bits_for(1), 1);
  EXPECT_GT(position_bits_for(std::numeric_limits<std::int32_t>::max()), kMaxPositionBits);
}

}  // namespace
}  // namespace geosis
