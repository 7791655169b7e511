#include "engine/volume/formats/sample_codec.h"

#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>

#include "engine/volume/formats/byte_reader.h"

namespace geosis {
namespace {

// The decoders below are flat loops over simple functions, which the compiler turns into vector code.
template <class Stored, bool big, class Convert>
void convert_all(const std::byte* bytes, std::span<float> samples, Convert convert) {
  for (std::size_t s = 0; s < samples.size(); ++s) samples[s] = convert(load<Stored>(bytes + s * sizeof(Stored), big));
}

template <class Stored, class Convert>
void convert_all(bool big_endian, const std::byte* bytes, std::span<float> samples, Convert convert) {
  if (big_endian)
    convert_all<Stored, true>(bytes, samples, convert);
  else
    convert_all<Stored, false>(bytes, samples, convert);
}

template <class Integer>
void decode_integers(bool big_endian, const std::byte* bytes, std::span<float> samples) {
  convert_all<Integer>(big_endian, bytes, samples, [](Integer value) { return static_cast<float>(value); });
}

// IBM System/360 float: sign, 7 bits of exponent to base 16 (excess 64), 24 bits of fraction, so that the value is
// fraction * 2^(4 * exponent - 256 - 24). Both factors are exact in double, and so is their product.
float from_ibm(std::uint32_t stored) {
  const auto fraction = static_cast<double>(static_cast<std::int32_t>(stored & 0xffffffu));
  const std::uint64_t exponent = (stored >> 24) & 0x7fu;
  const std::uint64_t sign = static_cast<std::uint64_t>(stored >> 31) << 63;
  const auto power = std::bit_cast<double>(sign | ((exponent * 4 + (1023 - 256 - 24)) << 52));
  return static_cast<float>(fraction * power);
}

float from_ieee32(std::uint32_t stored) {
  return std::bit_cast<float>(stored);
}

float from_ieee64(std::uint64_t stored) {
  const auto value = std::bit_cast<double>(stored);
  constexpr double beyond = 3.4028235677973366e38;  // halfway from the largest float to 2^128: rounds to infinity
  if (std::fabs(value) >= beyond)
    return std::copysign(std::numeric_limits<float>::infinity(), static_cast<float>(value < 0 ? -1 : 1));
  return static_cast<float>(value);
}

template <bool is_signed>
void decode_24_bits(bool big_endian, const std::byte* bytes, std::span<float> samples) {
  for (std::size_t s = 0; s < samples.size(); ++s) {
    const std::byte* b = bytes + 3 * s;
    const auto high = std::to_integer<std::uint32_t>(big_endian ? b[0] : b[2]);
    const auto middle = std::to_integer<std::uint32_t>(b[1]);
    const auto low = std::to_integer<std::uint32_t>(big_endian ? b[2] : b[0]);
    const std::uint32_t value = high << 16 | middle << 8 | low;
    // Shifted to the top first, so that the sign bit is the machine's own.
    samples[s] = is_signed ? static_cast<float>(static_cast<std::int32_t>(value << 8) >> 8) : static_cast<float>(value);
  }
}

}  // namespace

std::size_t bytes_per_sample(SampleCode code) {
  switch (code) {
    case SampleCode::int8:
    case SampleCode::uint8:
      return 1;
    case SampleCode::int16:
    case SampleCode::uint16:
      return 2;
    case SampleCode::int24:
    case SampleCode::uint24:
      return 3;
    case SampleCode::ibm32:
    case SampleCode::ieee32:
    case SampleCode::int32:
    case SampleCode::uint32:
      return 4;
    case SampleCode::ieee64:
    case SampleCode::int64:
    case SampleCode::uint64:
      return 8;
  }
  return 4;
}

void decode_samples(SampleCode code, bool big_endian, std::span<const std::byte> bytes, std::span<float> samples) {
  assert(bytes.size() == samples.size() * bytes_per_sample(code));
  const std::byte* from = bytes.data();
  switch (code) {
    case SampleCode::ibm32:
      return convert_all<std::uint32_t>(big_endian, from, samples, from_ibm);
    case SampleCode::ieee32:
      if (!big_endian) {  // as they are
        if (!samples.empty()) std::memcpy(samples.data(), from, samples.size_bytes());
        return;
      }
      return convert_all<std::uint32_t, true>(from, samples, from_ieee32);
    case SampleCode::ieee64:
      return convert_all<std::uint64_t>(big_endian, from, samples, from_ieee64);
    case SampleCode::int8:
      return decode_integers<std::int8_t>(big_endian, from, samples);
    case SampleCode::uint8:
      return decode_integers<std::uint8_t>(big_endian, from, samples);
    case SampleCode::int16:
      return decode_integers<std::int16_t>(big_endian, from, samples);
    case SampleCode::uint16:
      return decode_integers<std::uint16_t>(big_endian, from, samples);
    case SampleCode::int24:
      return decode_24_bits<true>(big_endian, from, samples);
    case SampleCode::uint24:
      return decode_24_bits<false>(big_endian, from, samples);
    case SampleCode::int32:
      return decode_integers<std::int32_t>(big_endian, from, samples);
    case SampleCode::uint32:
      return decode_integers<std::uint32_t>(big_endian, from, samples);
    case SampleCode::int64:
      return decode_integers<std::int64_t>(big_endian, from, samples);
    case SampleCode::uint64:
      return decode_integers<std::uint64_t>(big_endian, from, samples);
  }
}

NullValue::NullValue(std::optional<double> value, SampleCode code) {
  // A null beyond float32 rounds to infinity, and infinite samples are missing anyway.
  if (!value || !(std::fabs(*value) <= static_cast<double>(std::numeric_limits<float>::max()))) return;
  set_ = true;
  value_ = static_cast<float>(*value);
  // An IBM fraction may have as few as 21 significant bits, and writers truncate.
  if (code == SampleCode::ibm32) tolerance_ = std::fabs(value_) * 0x1p-20f;
}

// Most samples are finite and none stands for "missing": that is found without a branch in the loop. As integers the
// magnitudes of floats are ordered, and what is not finite lies beyond the largest float.
static bool are_plain(std::span<const float> samples) {
  constexpr auto largest = std::bit_cast<std::int32_t>(std::numeric_limits<float>::max());
  std::int32_t any = 0, room = 0;
  for (const float value : samples) {
    const std::int32_t magnitude = std::bit_cast<std::int32_t>(value) & 0x7fffffff;
    any |= magnitude;
    room |= largest - magnitude;
  }
  return any != 0 && room >= 0;
}

bool NullValue::keeps(std::span<const float> samples) const {
  return !set_ && are_plain(samples);
}

SampleCounts NullValue::clean(std::span<float> samples) const {
  constexpr float largest = std::numeric_limits<float>::max();
  if (keeps(samples)) return {.all_zero = false};
  SampleCounts counts;
  bool any_nonzero = false;
  for (float& value : samples) {
    const bool infinite = std::fabs(value) > largest;
    const bool null = set_ && std::fabs(value - value_) <= tolerance_;
    counts.infinite += infinite;
    any_nonzero |= value != 0;
    value = infinite || null ? std::numeric_limits<float>::quiet_NaN() : value;
    counts.missing += value != value;
  }
  counts.all_zero = !any_nonzero;
  return counts;
}

}  // namespace geosis
