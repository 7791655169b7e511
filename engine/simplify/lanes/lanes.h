// Eight floats side by side, for the instruction set at hand. Every header of this folder is compiled once for each of
// them (Highway's foreach_target), so nothing here is included in the usual way: see reduce_window.cpp.
//
// The same bits everywhere: one operation is one rounding (-ffp-contract=off), and sums over lanes have a fixed order.
#if defined(GEOSIS_SIMPLIFY_LANES_H) == defined(HWY_TARGET_TOGGLE)
#ifdef GEOSIS_SIMPLIFY_LANES_H
#undef GEOSIS_SIMPLIFY_LANES_H
#else
#define GEOSIS_SIMPLIFY_LANES_H
#endif

#include <cmath>
#include <cstdint>
#include <cstring>

#include <hwy/highway.h>

#include "engine/base/vec3.h"
#include "engine/simplify/float4.h"
#include "engine/simplify/working_vertex.h"

#ifdef __SSE2__
#include <immintrin.h>
#endif

HWY_BEFORE_NAMESPACE();
namespace geosis {
namespace HWY_NAMESPACE {

inline constexpr int kLanes = 8;

inline constexpr float kTiny = 1e-20f;  // keeps what may be zero from being divided by

using geosis::select;

#if HWY_MAX_BYTES >= 32

using Float8 = float __attribute__((vector_size(32)));
using Mask8 = std::int32_t __attribute__((vector_size(32)));  ///< of a comparison: -1 where it holds, else 0
using Int8 = Mask8;

HWY_INLINE Float8 all8(float x) {
  return Float8{x, x, x, x, x, x, x, x};
}
HWY_INLINE Int8 all8(std::int32_t x) {
  return Int8{x, x, x, x, x, x, x, x};
}
HWY_INLINE Float8 join(Float4 low, Float4 high) {
  return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
}
HWY_INLINE Float4 low_half(Float8 x) {
  return __builtin_shufflevector(x, x, 0, 1, 2, 3);
}
HWY_INLINE Float4 high_half(Float8 x) {
  return __builtin_shufflevector(x, x, 4, 5, 6, 7);
}
HWY_INLINE Float8 select(Mask8 mask, Float8 yes, Float8 no) {
  return mask ? yes : no;
}
HWY_INLINE Int8 select(Mask8 mask, Int8 yes, Int8 no) {
  return (mask & yes) | (~mask & no);
}
/// One bit a lane.
HWY_INLINE std::uint32_t bits_of(Mask8 mask) {
  return static_cast<std::uint32_t>(_mm256_movemask_ps(reinterpret_cast<__m256>(mask)));
}
HWY_INLINE Float8 square_root(Float8 x) {
  return reinterpret_cast<Float8>(_mm256_sqrt_ps(reinterpret_cast<__m256>(x)));
}
/// Rows of four become columns, in each half by itself.
HWY_INLINE void transpose_halves(Float8& a, Float8& b, Float8& c, Float8& d) {
  const Float8 ab_low = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
  const Float8 cd_low = __builtin_shufflevector(c, d, 0, 8, 1, 9, 4, 12, 5, 13);
  const Float8 ab_high = __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
  const Float8 cd_high = __builtin_shufflevector(c, d, 2, 10, 3, 11, 6, 14, 7, 15);
  a = __builtin_shufflevector(ab_low, cd_low, 0, 1, 8, 9, 4, 5, 12, 13);
  b = __builtin_shufflevector(ab_low, cd_low, 2, 3, 10, 11, 6, 7, 14, 15);
  c = __builtin_shufflevector(ab_high, cd_high, 0, 1, 8, 9, 4, 5, 12, 13);
  d = __builtin_shufflevector(ab_high, cd_high, 2, 3, 10, 11, 6, 7, 14, 15);
}

#else

struct Mask8 {
  Mask4 low, high;
};
using Int8 = Mask8;
struct Float8 {
  Float4 low, high;
};

HWY_INLINE Float8 all8(float x) {
  return {Float4{x, x, x, x}, Float4{x, x, x, x}};
}
HWY_INLINE Int8 all8(std::int32_t x) {
  return {Mask4{x, x, x, x}, Mask4{x, x, x, x}};
}
HWY_INLINE Float8 join(Float4 low, Float4 high) {
  return {low, high};
}
HWY_INLINE Float4 low_half(Float8 x) {
  return x.low;
}
HWY_INLINE Float4 high_half(Float8 x) {
  return x.high;
}
HWY_INLINE Float8 operator+(Float8 a, Float8 b) {
  return {a.low + b.low, a.high + b.high};
}
HWY_INLINE Float8 operator-(Float8 a, Float8 b) {
  return {a.low - b.low, a.high - b.high};
}
HWY_INLINE Float8 operator-(Float8 a) {
  return {-a.low, -a.high};
}
HWY_INLINE Float8 operator*(Float8 a, Float8 b) {
  return {a.low * b.low, a.high * b.high};
}
HWY_INLINE Float8 operator/(Float8 a, Float8 b) {
  return {a.low / b.low, a.high / b.high};
}
HWY_INLINE Float8 operator*(Float8 a, float b) {
  return {a.low * b, a.high * b};
}
HWY_INLINE Float8 operator/(float a, Float8 b) {
  return {a / b.low, a / b.high};
}
HWY_INLINE Float8 operator+(Float8 a, float b) {
  return {a.low + b, a.high + b};
}
HWY_INLINE Mask8 operator<(Float8 a, Float8 b) {
  return {a.low < b.low, a.high < b.high};
}
HWY_INLINE Mask8 operator<=(Float8 a, Float8 b) {
  return {a.low <= b.low, a.high <= b.high};
}
HWY_INLINE Mask8 operator<(Int8 a, Int8 b) {
  return {a.low < b.low, a.high < b.high};
}
HWY_INLINE Mask8 operator==(Int8 a, Int8 b) {
  return {a.low == b.low, a.high == b.high};
}
HWY_INLINE Mask8 operator&(Mask8 a, Mask8 b) {
  return {a.low & b.low, a.high & b.high};
}
HWY_INLINE Mask8 operator|(Mask8 a, Mask8 b) {
  return {a.low | b.low, a.high | b.high};
}
HWY_INLINE Mask8 operator~(Mask8 a) {
  return {~a.low, ~a.high};
}
HWY_INLINE Float8 select(Mask8 mask, Float8 yes, Float8 no) {
  return {mask.low ? yes.low : no.low, mask.high ? yes.high : no.high};
}
HWY_INLINE Int8 select(Mask8 mask, Int8 yes, Int8 no) {
  return (mask & yes) | (~mask & no);
}
HWY_INLINE void transpose_halves(Float8& a, Float8& b, Float8& c, Float8& d) {
  transpose(a.low, b.low, c.low, d.low);
  transpose(a.high, b.high, c.high, d.high);
}
#ifdef __SSE2__
HWY_INLINE std::uint32_t bits_of(Mask8 mask) {
  return static_cast<std::uint32_t>(_mm_movemask_ps(reinterpret_cast<__m128>(mask.low)) |
                                    _mm_movemask_ps(reinterpret_cast<__m128>(mask.high)) << 4);
}
HWY_INLINE Float8 square_root(Float8 x) {
  return {reinterpret_cast<Float4>(_mm_sqrt_ps(reinterpret_cast<__m128>(x.low))),
          reinterpret_cast<Float4>(_mm_sqrt_ps(reinterpret_cast<__m128>(x.high)))};
}
#else
HWY_INLINE std::uint32_t bits_of(Mask8 mask) {
  std::uint32_t bits = 0;
  for (int i = 0; i < 4; ++i) bits |= (mask.low[i] & 1u) << i | (mask.high[i] & 1u) << (4 + i);
  return bits;
}
HWY_INLINE Float8 square_root(Float8 x) {
  for (int i = 0; i < 4; ++i) x.low[i] = std::sqrt(x.low[i]), x.high[i] = std::sqrt(x.high[i]);
  return x;
}
#endif

#endif

HWY_INLINE bool any(Mask8 mask) {
  return bits_of(mask) != 0;
}
/// The sums over the lanes of each of four.
HWY_INLINE Float4 sums_of(Float8 a, Float8 b, Float8 c, Float8 d) {
  Float4 p = low_half(a) + high_half(a), q = low_half(b) + high_half(b);
  Float4 r = low_half(c) + high_half(c), s = low_half(d) + high_half(d);
  transpose(p, q, r, s);
  return (p + q) + (r + s);
}
HWY_INLINE Float8 magnitude(Float8 x) {
  return select(x < Float8{}, -x, x);
}
/// The lanes first ... first + 7 that are below end.
HWY_INLINE Mask8 lanes_below(int first, int end) {
  const std::int32_t lane[kLanes] = {0, 1, 2, 3, 4, 5, 6, 7};
  Int8 lanes;
  std::memcpy(&lanes, lane, sizeof(lanes));
  return lanes < all8(static_cast<std::int32_t>(end - first));
}

/// Vec3 of lanes or floats. Its own type, since what is instantiated must belong to the instruction set.
template <class F>
struct V3 {
  F x, y, z;

  HWY_INLINE V3 operator+(V3 b) const { return {x + b.x, y + b.y, z + b.z}; }
  HWY_INLINE V3 operator-(V3 b) const { return {x - b.x, y - b.y, z - b.z}; }
  HWY_INLINE V3 operator*(F s) const { return {x * s, y * s, z * s}; }
};

template <class F>
HWY_INLINE F dot(V3<F> a, V3<F> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class F>
HWY_INLINE V3<F> cross(V3<F> a, V3<F> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class F, class M>
HWY_INLINE V3<F> select(M mask, V3<F> yes, V3<F> no) {
  return {select(mask, yes.x, no.x), select(mask, yes.y, no.y), select(mask, yes.z, no.z)};
}
HWY_INLINE V3<Float8> all8(Vec3f v) {
  return {all8(v.x), all8(v.y), all8(v.z)};
}
HWY_INLINE V3<float> plain(Vec3f v) {
  return {v.x, v.y, v.z};
}

/// Row i of the records of eight vertices, as columns.
HWY_INLINE void columns_of(const WorkingVertex* const (&v)[kLanes], std::size_t row, Float8& a, Float8& b, Float8& c,
                           Float8& d) {
  a = join(v[0]->row(row), v[4]->row(row));
  b = join(v[1]->row(row), v[5]->row(row));
  c = join(v[2]->row(row), v[6]->row(row));
  d = join(v[3]->row(row), v[7]->row(row));
  transpose_halves(a, b, c, d);
}

HWY_INLINE V3<Float8> positions_of(const WorkingVertex* const (&v)[kLanes]) {
  V3<Float8> p;
  Float8 unused;
  columns_of(v, 0, p.x, p.y, p.z, unused);
  return p;
}

}  // namespace HWY_NAMESPACE
}  // namespace geosis
HWY_AFTER_NAMESPACE();

#endif
