#include "engine/structure/tensor_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace geosis {
namespace {

constexpr int kSquarings = 6;
constexpr float kLeastDown = 1e-6f;  // of the direction's part down the trace, squared: planes steeper than any kept

}  // namespace

void gradient_products(const float* gradient, const float* weight, std::size_t count, float* terms) {
  const float *gx = gradient, *gy = gradient + count, *gz = gradient + 2 * count;
  for (std::size_t k = 0; k < count; ++k) {
    const float x = weight[k] * gx[k], y = weight[k] * gy[k], z = weight[k] * gz[k];
    terms[k] = x * gx[k];
    terms[count + k] = y * gy[k];
    terms[2 * count + k] = z * gz[k];
    terms[3 * count + k] = x * gy[k];
    terms[4 * count + k] = x * gz[k];
    terms[5 * count + k] = y * gz[k];
  }
}

void main_dips(const float* tensor, std::size_t count, float least, float* dip) {
  for (std::size_t k = 0; k < count; ++k) {
    float xx = tensor[k], yy = tensor[count + k], zz = tensor[2 * count + k];
    float xy = tensor[3 * count + k], xz = tensor[4 * count + k], yz = tensor[5 * count + k];
    const float trace = xx + yy + zz;
    const float scale = 1.0f / std::max(trace, least);
    xx *= scale, yy *= scale, zz *= scale, xy *= scale, xz *= scale, yz *= scale;
    for (int n = 0; n < kSquarings; ++n) {
      const float a = xx * xx + xy * xy + xz * xz, b = xy * xy + yy * yy + yz * yz, c = xz * xz + yz * yz + zz * zz;
      const float d = xx * xy + xy * yy + xz * yz, e = xx * xz + xy * yz + xz * zz, f = xy * xz + yy * yz + yz * zz;
      const float again = 1.0f / std::max(a + b + c, std::numeric_limits<float>::min());
      xx = a * again, yy = b * again, zz = c * again, xy = d * again, xz = e * again, yz = f * again;
    }
    const float down = std::max(zz, kLeastDown);
    const float unknown = trace > least ? 0.0f : std::numeric_limits<float>::quiet_NaN();
    dip[k] = unknown - xz / down;
    dip[count + k] = unknown - yz / down;
  }
}

}  // namespace geosis
