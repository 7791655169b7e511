#include "engine/missing/bit_lines.h"

namespace geosis {

// Squares of 32, 16, ... 1 bits: the upper right one changes places with the lower left one.
void transpose(std::span<std::uint64_t, 64> square) {
  std::uint64_t left = 0x00000000ffffffff;  // columns of the left half of each square
  for (std::size_t half = 32; half != 0; half /= 2, left ^= left << half) {
    for (std::size_t a = 0; a < 64; a = (a + half + 1) & ~half) {
      const std::uint64_t changed = (square[a] >> half ^ square[a + half]) & left;
      square[a] ^= changed << half;
      square[a + half] ^= changed;
    }
  }
}

}  // namespace geosis
