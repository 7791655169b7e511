#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace geosis {

/// A double with a bound of its rounding error: decides a sign in almost every case.
struct Bounded {
  double value = 0, error = 0;

  Bounded() = default;
  explicit Bounded(double exact) : value(exact) {}
  Bounded(double v, double e) : value(v), error(e) {}

  bool decides() const { return value > error || value < -error || error == 0; }
};

namespace detail {
// Twice the rounding unit, so that the roundings of the bound itself are covered.
inline constexpr double kRounding = 2.220446049250313e-16;
// More than the products below can lose where they are too small for a double's full precision.
inline constexpr double kUnderflow = std::numeric_limits<double>::min();
}  // namespace detail

inline Bounded operator+(Bounded a, Bounded b) {
  const double value = a.value + b.value;
  return {value, a.error + b.error + detail::kRounding * (std::fabs(value) + a.error + b.error)};
}
inline Bounded operator-(Bounded a, Bounded b) {
  return a + Bounded{-b.value, b.error};
}
inline Bounded operator*(Bounded a, Bounded b) {
  const bool is_zero = (a.value == 0 && a.error == 0) || (b.value == 0 && b.error == 0);
  if (is_zero) return {};
  const double value = a.value * b.value;
  const double carried = std::fabs(a.value) * b.error + std::fabs(b.value) * a.error + a.error * b.error;
  return {value, carried + detail::kRounding * (std::fabs(value) + carried) + detail::kUnderflow};
}

/// An exact number: the unevaluated sum of long doubles that do not overlap, smallest first.
///
/// Exact for polynomials up to degree 4 of float32 values and of doubles formed as products of two of them, scaled or
/// not: such numbers lie between 2^-2224 and 2^1040, more than a double's exponents hold and far within those of a long
/// double. Slow, so used only where Bounded does not decide. source   Shewchuk 1997, "Adaptive precision
/// floating-point arithmetic".
class Exact {
  using Part = long double;
  static_assert(std::numeric_limits<Part>::min_exponent <= -16381 && std::numeric_limits<Part>::max_exponent >= 16384);

 public:
  Exact() = default;
  explicit Exact(double value) {
    if (value != 0) parts_.push_back(value);
  }

  int sign() const { return parts_.empty() ? 0 : parts_.back() > 0 ? 1 : -1; }

  friend Exact operator+(Exact a, const Exact& b) {
    for (const Part part : b.parts_) a.add(part);
    return a;
  }
  friend Exact operator-(const Exact& a, const Exact& b) {
    Exact sum = a;
    for (const Part part : b.parts_) sum.add(-part);
    return sum;
  }
  friend Exact operator*(const Exact& a, const Exact& b) {
    Exact product;
    for (const Part x : a.parts_) {
      for (const Part y : b.parts_) {
        const Part high = x * y;
        product.add(product_error(x, y, high));
        product.add(high);
      }
    }
    return product;
  }

 private:
  // Grow-expansion with zero elimination.
  void add(Part carry) {
    std::size_t kept = 0;
    for (const Part part : parts_) {
      const Part sum = carry + part;
      const Part from_part = sum - carry;
      const Part rest = (carry - (sum - from_part)) + (part - from_part);
      if (rest != 0) parts_[kept++] = rest;
      carry = sum;
    }
    parts_.resize(kept);
    if (carry != 0) parts_.push_back(carry);
  }

  // Error of high = x * y, by splitting each factor into two halves of its bits (Dekker, Veltkamp).
  static Part product_error(Part x, Part y, Part high) {
    constexpr int kHalf = (std::numeric_limits<Part>::digits + 1) / 2;
    constexpr Part kSplitter = static_cast<Part>(std::uint64_t{1} << kHalf) + 1;
    const Part cx = kSplitter * x, cy = kSplitter * y;
    const Part xh = cx - (cx - x), yh = cy - (cy - y);
    const Part xl = x - xh, yl = y - yh;
    return xl * yl - (((high - xh * yh) - xl * yh) - xh * yl);
  }

  std::vector<Part> parts_;
};

}  // namespace geosis
