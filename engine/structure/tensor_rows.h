#pragma once

#include <cstddef>

namespace geosis {

/// Terms of a symmetric tensor in the arrays below: xx, yy, zz, xy, xz, yz, each `count` numbers in a row.
inline constexpr std::size_t kTensorTerms = 6;

/// terms (6, count) = weight (count) * gradient (3, count) times itself.
void gradient_products(const float* gradient, const float* weight, std::size_t count, float* terms);

/// Dips of the planes at right angles to each tensor's main direction.
///
/// tensor   (6, count), not below zero as tensors go.
/// least    where its trace is not more than this, nothing is known: NaN.
/// dip      (2, count): samples a trace towards the next inline, and towards the next crossline; never infinite.
/// source   powers of a matrix turn into its main direction: T, T^2, T^4 ... T^64, by squaring. No branches, so that
///          the compiler works on several at a time.
void main_dips(const float* tensor, std::size_t count, float least, float* dip);

}  // namespace geosis
