#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace geosis {

/// How a stored sample is written.
enum class SampleCode {
  ibm32,
  ieee32,
  ieee64,
  int8,
  uint8,
  int16,
  uint16,
  int24,
  uint24,
  int32,
  uint32,
  int64,
  uint64
};

std::size_t bytes_per_sample(SampleCode code);

/// Stored samples to float32, rounded to nearest even; what lies beyond float32 becomes infinite.
///
/// bytes  samples.size() * bytes_per_sample(code) of them.
void decode_samples(SampleCode code, bool big_endian, std::span<const std::byte> bytes, std::span<float> samples);

/// What clean_samples found.
struct SampleCounts {
  std::int64_t missing = 0;   ///< NaN afterwards, infinite ones included
  std::int64_t infinite = 0;  ///< were infinite
  bool all_zero = true;
};

/// Samples that stand for "missing": rounded to float32, with the room that truncated IBM floats need.
class NullValue {
 public:
  NullValue() = default;
  NullValue(std::optional<double> value, SampleCode code);

  /// Turns null and infinite samples into NaN and counts.
  SampleCounts clean(std::span<float> samples) const;
  /// Whether clean() would surely change none of them; they are not all zero then.
  bool keeps(std::span<const float> samples) const;

 private:
  bool set_ = false;
  float value_ = 0;
  float tolerance_ = 0;
};

}  // namespace geosis
