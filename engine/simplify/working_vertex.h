#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/base/vec3.h"
#include "engine/simplify/float4.h"
#include "engine/simplify/quadric.h"

namespace geosis {

/// A vertex while levels are made: one cache line. Position and quadric (in the vertex's own frame) lie so that
/// vertices become lanes by transposing rows of four floats:
///
///   row 0   x   y   z   c
///   row 1   a00 a01 a02 b0
///   row 2   a11 a12 a22 b1
///   then    b2
struct alignas(64) WorkingVertex {
  Vec3f position;
  float c;
  float a00, a01, a02, b0;
  float a11, a12, a22, b1;
  float b2;
  std::int32_t origin;  ///< vertex of M0
  bool on_boundary;
  bool locked;  ///< for this pass: a triangle leaves the window

  Quadric quadric() const { return {a00, a01, a02, a11, a12, a22, b0, b1, b2, c}; }

  void set_quadric(const Quadric& q) {
    a00 = q.a00, a01 = q.a01, a02 = q.a02, a11 = q.a11, a12 = q.a12, a22 = q.a22;
    b0 = q.b0, b1 = q.b1, b2 = q.b2;
    c = q.c;
  }

  void set_row(std::size_t i, Float4 x) {
    std::memcpy(reinterpret_cast<char*>(this) + i * sizeof(Float4), &x, sizeof(x));
  }
  Float4 row(std::size_t i) const { return load4(reinterpret_cast<const char*>(this) + i * sizeof(Float4)); }
};
static_assert(sizeof(WorkingVertex) == 64);
static_assert(offsetof(WorkingVertex, c) == 12 && offsetof(WorkingVertex, a00) == 16 &&
              offsetof(WorkingVertex, a11) == 32 && offsetof(WorkingVertex, b2) == 48);

/// A vertex of M0 that nothing is known of but its place.
inline WorkingVertex make_vertex(Vec3f position, std::int32_t origin) {
  WorkingVertex vertex{};
  vertex.position = position;
  vertex.origin = origin;
  return vertex;
}

inline Vec3<Float4> all4(Vec3f p) {
  return {all4(p.x), all4(p.y), all4(p.z)};
}

}  // namespace geosis
