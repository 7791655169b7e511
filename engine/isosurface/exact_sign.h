#pragma once

#include <cmath>
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
}  // namespace detail

inline Bounded operator+(Bounded a, Bounded b) {
  const double value = a.value + b.value;
  return {value, a.error + b.error + detail::kRounding * (std::fabs(value) + a.error + b.error)};
}
inline Bounded operator-(Bounded a, Bounded b) {
  return a + Bounded{-b.value, b.error};
}
inline Bounded operator*(Bounded a, Bounded b) {
  const double value = a.value * b.value;
  const double carried = std::fabs(a.value) * b.error + std::fabs(b.value) * a.error + a.error * b.error;
  return {value, carried + detail::kRounding * (std::fabs(value) + carried)};
}

/// An exact number: the unevaluated sum of doubles that do not overlap, smallest first.
///
/// Exact for polynomials up to degree 4 of float32 values, and up to degree 2 of products of two of them: no
/// intermediate leaves the exponent range. Slow, so used only where Bounded does not decide. source   Shewchuk 1997,
/// "Adaptive precision floating-point arithmetic".
class Exact {
 public:
  Exact() = default;
  explicit Exact(double value) {
    if (value != 0) parts_.push_back(value);
  }

  int sign() const { return parts_.empty() ? 0 : parts_.back() > 0 ? 1 : -1; }

  friend Exact operator+(Exact a, const Exact& b) {
    for (double part : b.parts_) a.add(part);
    return a;
  }
  friend Exact operator-(const Exact& a, const Exact& b) {
    Exact sum = a;
    for (double part : b.parts_) sum.add(-part);
    return sum;
  }
  friend Exact operator*(const Exact& a, const Exact& b) {
    Exact product;
    for (double x : a.parts_) {
      for (double y : b.parts_) {
        const double high = x * y;
        product.add(product_error(x, y, high));
        product.add(high);
      }
    }
    return product;
  }

 private:
  // Grow-expansion with zero elimination.
  void add(double carry) {
    std::size_t kept = 0;
    for (double part : parts_) {
      const double sum = carry + part;
      const double from_part = sum - carry;
      const double rest = (carry - (sum - from_part)) + (part - from_part);
      if (rest != 0) parts_[kept++] = rest;
      carry = sum;
    }
    parts_.resize(kept);
    if (carry != 0) parts_.push_back(carry);
  }

  // Error of high = x * y, by splitting each factor into two halves of 26 bits (Dekker, Veltkamp).
  static double product_error(double x, double y, double high) {
    constexpr double kSplitter = 134217729.0;  // 2^27 + 1
    const double cx = kSplitter * x, cy = kSplitter * y;
    const double xh = cx - (cx - x), yh = cy - (cy - y);
    const double xl = x - xh, yl = y - yh;
    return xl * yl - (((high - xh * yh) - xl * yh) - xh * yl);
  }

  std::vector<double> parts_;
};

}  // namespace geosis
