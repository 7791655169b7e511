#pragma once

#include <cmath>

namespace geosis {

/// Three numbers: an index position (i, j, k) or a world position (x, y, z).
template <class T>
struct Vec3 {
  T x{}, y{}, z{};

  constexpr T operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  constexpr T& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }

  constexpr bool operator==(const Vec3&) const = default;
  constexpr Vec3 operator+(Vec3 b) const { return {x + b.x, y + b.y, z + b.z}; }
  constexpr Vec3 operator-(Vec3 b) const { return {x - b.x, y - b.y, z - b.z}; }
  constexpr Vec3 operator*(T s) const { return {x * s, y * s, z * s}; }
};

using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;

template <class T>
constexpr T dot(Vec3<T> a, Vec3<T> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class T>
constexpr Vec3<T> cross(Vec3<T> a, Vec3<T> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class T>
T norm(Vec3<T> a) {
  return std::sqrt(dot(a, a));
}

constexpr Vec3d to_double(Vec3f a) {
  return {a.x, a.y, a.z};
}

}  // namespace geosis
