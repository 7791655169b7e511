#pragma once

#include <cstdint>
#include <cstring>

namespace geosis {

/// Four floats side by side. GCC and Clang turn the plain operators into one vector instruction where the processor has
/// it (SSE2 is enough) and into four scalar ones elsewhere: the same bits either way.
using Float4 = float __attribute__((vector_size(16)));
using Mask4 = std::int32_t __attribute__((vector_size(16)));  ///< of a comparison: -1 where it holds, else 0

inline constexpr int kLanes = 4;

inline Float4 all4(float x) {
  return Float4{x, x, x, x};
}

inline Float4 load4(const void* from) {
  Float4 result;
  std::memcpy(&result, from, sizeof(result));
  return result;
}

inline float select(bool condition, float yes, float no) {
  return condition ? yes : no;
}

inline float sum(Float4 x) {
  return (x[0] + x[1]) + (x[2] + x[3]);
}

/// Rows become columns.
inline void transpose(Float4& a, Float4& b, Float4& c, Float4& d) {
  const Float4 ab_low = __builtin_shufflevector(a, b, 0, 4, 1, 5);
  const Float4 cd_low = __builtin_shufflevector(c, d, 0, 4, 1, 5);
  const Float4 ab_high = __builtin_shufflevector(a, b, 2, 6, 3, 7);
  const Float4 cd_high = __builtin_shufflevector(c, d, 2, 6, 3, 7);
  a = __builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5);
  b = __builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7);
  c = __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5);
  d = __builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7);
}

}  // namespace geosis
