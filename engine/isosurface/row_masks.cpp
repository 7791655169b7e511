#include "engine/isosurface/row_masks.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/isosurface/row_masks.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace geosis {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class D, class M>
std::uint64_t bits_of(D d, M mask, std::size_t place) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  std::uint64_t bits = 0;
  for (int n = 7; n >= 0; --n) bits = bits << 8 | bytes[n];
  return bits << place;
}

void ClassifyRows(const float* HWY_RESTRICT samples, std::size_t rows, std::size_t length, float low, float high,
                  RowMasks* HWY_RESTRICT masks) {
  const hn::CappedTag<float, 16> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto lows = hn::Set(d, low), highs = hn::Set(d, high);
  const std::size_t whole = length - length % lanes;
  for (std::size_t row = 0; row < rows; ++row, samples += length) {
    RowMasks bits;
    for (std::size_t n = 0; n < whole; n += lanes) {
      const auto f = hn::LoadU(d, samples + n);
      bits.valid |= bits_of(d, hn::Eq(f, f), n);
      bits.at_least |= bits_of(d, hn::Ge(f, lows), n);
      bits.greater |= bits_of(d, hn::Gt(f, highs), n);
    }
    for (std::size_t n = whole; n < length; ++n) {
      const float f = samples[n];
      bits.valid |= std::uint64_t{f == f} << n;
      bits.at_least |= std::uint64_t{f >= low} << n;
      bits.greater |= std::uint64_t{f > high} << n;
    }
    masks[row] = bits;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace geosis
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geosis {

HWY_EXPORT(ClassifyRows);

void classify_rows(const float* samples, std::size_t rows, std::size_t length, float low, float high, RowMasks* masks) {
  HWY_DYNAMIC_DISPATCH(ClassifyRows)(samples, rows, length, low, high, masks);
}

void classify_rows_scalar(const float* samples, std::size_t rows, std::size_t length, float low, float high,
                          RowMasks* masks) {
  for (std::size_t row = 0; row < rows; ++row) {
    RowMasks bits;
    for (std::size_t n = 0; n < length; ++n) {
      const float f = samples[row * length + n];
      bits.valid |= std::uint64_t{f == f} << n;
      bits.at_least |= std::uint64_t{f >= low} << n;
      bits.greater |= std::uint64_t{f > high} << n;
    }
    masks[row] = bits;
  }
}

}  // namespace geosis
#endif
