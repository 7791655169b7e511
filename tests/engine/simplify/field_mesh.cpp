#include "tests/engine/simplify/field_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace geosis {
namespace {

/// A corner of a cell, as three bits: i, j, k.
using Corner = int;

/// The six tetrahedra around a cell's diagonal from corner 0 to corner 7, one for each order of the axes, all with
/// positive volume.
constexpr Corner kTetrahedra[6][4] = {{0, 4, 6, 7}, {0, 6, 2, 7}, {0, 2, 3, 7},
                                      {0, 3, 1, 7}, {0, 1, 5, 7}, {0, 5, 4, 7}};

class Mesher {
 public:
  Mesher(std::array<int, 3> shape, const NodeField& field) : shape_(shape), values_(nodes()) {
    std::size_t at = 0;
    for (int i = 0; i < shape[0]; ++i) {
      for (int j = 0; j < shape[1]; ++j) {
        for (int k = 0; k < shape[2]; ++k) values_[at++] = field(i, j, k);
      }
    }
    vertex_on_edge_.assign(values_.size() * 8, -1);
  }

  IndexedMesh run() {
    for (int i = 0; i + 1 < shape_[0]; ++i) {
      for (int j = 0; j + 1 < shape_[1]; ++j) {
        for (int k = 0; k + 1 < shape_[2]; ++k) {
          for (const auto& tetrahedron : kTetrahedra) cut(node(i, j, k), tetrahedron);
        }
      }
    }
    return std::move(mesh_);
  }

 private:
  std::size_t nodes() const { return static_cast<std::size_t>(shape_[0]) * shape_[1] * shape_[2]; }
  std::size_t node(int i, int j, int k) const { return (static_cast<std::size_t>(i) * shape_[1] + j) * shape_[2] + k; }
  std::size_t step(Corner c) const { return node(c >> 2 & 1, c >> 1 & 1, c & 1); }

  void cut(std::size_t origin, const Corner (&corners)[4]) {
    // Inside corners first; an odd permutation mirrors the tetrahedron.
    std::array<Corner, 4> sorted{};
    int inside = 0;
    int at = 0;
    bool mirrored = false;
    for (int c = 0; c < 4; ++c) {
      if (values_[origin + step(corners[c])] >= 0) continue;
      mirrored ^= (c - at) % 2 != 0;
      sorted[at++] = corners[c];
      ++inside;
    }
    for (int c = 0; c < 4; ++c) {
      if (values_[origin + step(corners[c])] >= 0) sorted[at++] = corners[c];
    }
    if (inside == 0 || inside == 4) return;
    const auto on = [&](int a, int b) { return vertex(origin, sorted[a], sorted[b]); };
    if (inside == 1) add(on(0, 1), on(0, 2), on(0, 3), mirrored);
    if (inside == 3) add(on(0, 3), on(2, 3), on(1, 3), !mirrored);
    if (inside == 2) {
      add(on(0, 2), on(0, 3), on(1, 3), mirrored);
      add(on(0, 2), on(1, 3), on(1, 2), mirrored);
    }
  }

  void add(std::int32_t a, std::int32_t b, std::int32_t c, bool mirrored) {
    mesh_.triangles.push_back(mirrored ? Triangle{a, c, b} : Triangle{a, b, c});
  }

  /// The crossing of the edge between two corners of a cell, made once.
  std::int32_t vertex(std::size_t origin, Corner a, Corner b) {
    if (a > b) std::swap(a, b);  // every edge goes up along its axes
    const std::size_t low = origin + step(a);
    std::int32_t& known = vertex_on_edge_[low * 8 + static_cast<std::size_t>(b - a)];
    if (known >= 0) return known;
    const double f = values_[low];
    const double share = f / (f - values_[origin + step(b)]);
    const float t = static_cast<float>(std::clamp(std::round(share * 64), 1.0, 63.0) / 64);
    const Corner axes = b - a;
    mesh_.positions.push_back({static_cast<float>(low / (static_cast<std::size_t>(shape_[1]) * shape_[2])) +
                                   t * static_cast<float>(axes >> 2 & 1),
                               static_cast<float>(low / shape_[2] % shape_[1]) + t * static_cast<float>(axes >> 1 & 1),
                               static_cast<float>(low % shape_[2]) + t * static_cast<float>(axes & 1)});
    return known = static_cast<std::int32_t>(mesh_.positions.size()) - 1;
  }

  const std::array<int, 3> shape_;
  std::vector<double> values_;
  std::vector<std::int32_t> vertex_on_edge_;  // (nodes, 8): lower node, axes along which the edge goes
  IndexedMesh mesh_;
};

}  // namespace

IndexedMesh mesh_field(std::array<int, 3> shape, const NodeField& field) {
  return Mesher(shape, field).run();
}

NodeField ball(Vec3d centre, double radius) {
  return [=](int i, int j, int k) {
    return norm(Vec3d{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)} - centre) - radius;
  };
}

NodeField torus(Vec3d centre, double major, double minor) {
  return [=](int i, int j, int k) {
    const Vec3d p = Vec3d{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)} - centre;
    const double ring = std::sqrt(p.x * p.x + p.y * p.y) - major;
    return std::sqrt(ring * ring + p.z * p.z) - minor;
  };
}

NodeField gyroid(double period, double level) {
  return [=](int i, int j, int k) {
    const double s = 2 * std::numbers::pi / period;
    return std::sin(s * i) * std::cos(s * j) + std::sin(s * j) * std::cos(s * k) + std::sin(s * k) * std::cos(s * i) -
           level;
  };
}

NodeField noise(std::uint64_t seed) {
  return [=](int i, int j, int k) {
    std::uint64_t x = seed + (static_cast<std::uint64_t>(i) << 42 | static_cast<std::uint64_t>(j) << 21 |
                              static_cast<std::uint64_t>(k));
    for (int round = 0; round < 2; ++round) {  // splitmix64's mixer
      x = (x + 0x9e3779b97f4a7c15u) * 0xbf58476d1ce4e5b9u;
      x = (x ^ x >> 27) * 0x94d049bb133111ebu;
      x ^= x >> 31;
    }
    return static_cast<double>(x >> 11) * 0x1p-52 - 1;
  };
}

NodeField closed_on_faces(std::array<int, 3> shape, NodeField field) {
  return [=](int i, int j, int k) {
    const bool on_face = i == 0 || j == 0 || k == 0 || i == shape[0] - 1 || j == shape[1] - 1 || k == shape[2] - 1;
    return on_face ? 1.0 : field(i, j, k);
  };
}

}  // namespace geosis
