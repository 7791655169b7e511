#pragma once

#include <cstdint>

namespace geosis::test {

/// SplitMix64: the same numbers on every machine, one 64-bit seed.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t bits() {
    std::uint64_t z = state_ += 0x9E3779B97F4A7C15u;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  }
  /// Uniform in [0, 1).
  double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  float between(float low, float high) { return static_cast<float>(low + (high - low) * unit()); }
  /// Uniform over first ... last.
  std::int32_t integer(std::int32_t first, std::int32_t last) {
    return first + static_cast<std::int32_t>(bits() % static_cast<std::uint64_t>(last - first + 1));
  }

 private:
  std::uint64_t state_;
};

/// The seed of the property tests: environment variable GEOSIS_SEED, or the given one.
std::uint64_t test_seed(std::uint64_t otherwise);

}  // namespace geosis::test
