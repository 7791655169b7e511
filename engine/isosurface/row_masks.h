#pragma once

#include <cstddef>
#include <cstdint>

namespace geosis {

/// One row of at most 64 samples as bits, sample n in bit n. NaN sets none of them.
struct RowMasks {
  std::uint64_t valid = 0;     ///< not missing
  std::uint64_t at_least = 0;  ///< f >= low
  std::uint64_t greater = 0;   ///< f > high
};

/// Masks of `rows` rows of `length` (1..64) samples that follow one another.
///
/// Chooses the widest vector instructions of the processor; all give the same bits.
void classify_rows(const float* samples, std::size_t rows, std::size_t length, float low, float high, RowMasks* masks);

/// The same by a plain loop: what the vector code is tested against.
void classify_rows_scalar(const float* samples, std::size_t rows, std::size_t length, float low, float high,
                          RowMasks* masks);

}  // namespace geosis
