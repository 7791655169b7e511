#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "engine/mesh/indexed_mesh.h"

/// Meshes of known shape whose vertices lie on the 1/64 lattice, for tests of what works on whole levels.
namespace geosis::test {

inline Vec3f snap(Vec3d p) {
  const auto to_lattice = [](double x) {
    return static_cast<float>(std::round(x * kLatticeStepsPerVoxel)) * kLatticeStep;
  };
  return {to_lattice(p.x), to_lattice(p.y), to_lattice(p.z)};
}

/// Sphere of rings x sectors quads (triangles at the poles), looking outwards.
inline IndexedMesh sphere(Vec3d center, double radius, int rings, int sectors) {
  IndexedMesh mesh;
  const auto at = [&](double polar, double azimuth) {
    const Vec3d direction = {std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)};
    mesh.positions.push_back(snap(center + direction * radius));
  };
  at(0, 0);
  for (int r = 1; r < rings; ++r) {
    for (int s = 0; s < sectors; ++s) at(std::numbers::pi * r / rings, 2 * std::numbers::pi * s / sectors);
  }
  at(std::numbers::pi, 0);
  const auto vertex = [&](int r, int s) {
    if (r == 0) return 0;
    return r == rings ? (rings - 1) * sectors + 1 : 1 + (r - 1) * sectors + s % sectors;
  };
  for (int r = 0; r < rings; ++r) {
    for (int s = 0; s < sectors; ++s) {
      if (r > 0) mesh.triangles.push_back({vertex(r, s), vertex(r + 1, s), vertex(r, s + 1)});
      if (r + 1 < rings) mesh.triangles.push_back({vertex(r + 1, s), vertex(r + 1, s + 1), vertex(r, s + 1)});
    }
  }
  return mesh;
}

/// Torus around the k axis of its center, looking outwards.
inline IndexedMesh torus(Vec3d center, double ring_radius, double tube_radius, int around, int across) {
  IndexedMesh mesh;
  for (int u = 0; u < around; ++u) {
    for (int v = 0; v < across; ++v) {
      const double azimuth = 2 * std::numbers::pi * u / around, tube = 2 * std::numbers::pi * v / across;
      const double r = ring_radius + tube_radius * std::cos(tube);
      const Vec3d offset = {r * std::cos(azimuth), r * std::sin(azimuth), tube_radius * std::sin(tube)};
      mesh.positions.push_back(snap(center + offset));
    }
  }
  const auto vertex = [&](int u, int v) { return u % around * across + v % across; };
  for (int u = 0; u < around; ++u) {
    for (int v = 0; v < across; ++v) {
      mesh.triangles.push_back({vertex(u, v), vertex(u + 1, v), vertex(u, v + 1)});
      mesh.triangles.push_back({vertex(u + 1, v), vertex(u + 1, v + 1), vertex(u, v + 1)});
    }
  }
  return mesh;
}

/// Open square sheet of side x side cells in the plane k = depth, looking along +k.
inline IndexedMesh sheet(int side, float depth, float cell = 1) {
  IndexedMesh mesh;
  for (int i = 0; i <= side; ++i) {
    for (int j = 0; j <= side; ++j) {
      mesh.positions.push_back({static_cast<float>(i) * cell, static_cast<float>(j) * cell, depth});
    }
  }
  const auto vertex = [&](int i, int j) { return i * (side + 1) + j; };
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)});
      mesh.triangles.push_back({vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  }
  return mesh;
}

/// Box between two lattice corners, looking outwards.
inline IndexedMesh box(Vec3f low, Vec3f high) {
  IndexedMesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.positions.push_back({corner & 4 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 1 ? high.z : low.z});
  }
  mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1},
                    {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
  return mesh;
}

/// By value: a mesh may be appended to itself.
inline void append(IndexedMesh& mesh, IndexedMesh other) {
  const auto offset = static_cast<std::int32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({a + offset, b + offset, c + offset});
}

/// Spheres and tori of random size and place inside [0, 64]^3; they may cross, for nothing here looks at space.
inline IndexedMesh random_shapes(std::mt19937& random, int count) {
  std::uniform_real_distribution<double> place(16, 48), size(1, 8);
  std::uniform_int_distribution<int> steps(3, 12);
  IndexedMesh mesh;
  for (int shape = 0; shape < count; ++shape) {
    const Vec3d center = {place(random), place(random), place(random)};
    const double radius = size(random);
    const int rings = steps(random), sectors = steps(random);
    append(mesh, shape % 3 == 2 ? torus(center, radius + 4, radius / 2, rings, sectors)
                                : sphere(center, radius, rings, sectors));
  }
  return mesh;
}

/// Each triangle as its three positions, turned so that they read smallest, the turning sense kept; all sorted. Equal
/// for meshes that differ only in the order of vertices and triangles.
inline std::vector<std::array<float, 9>> triangle_multiset(const IndexedMesh& mesh) {
  const auto written = [&](std::int32_t a, std::int32_t b, std::int32_t c) {
    const Vec3f p = mesh.positions[a], q = mesh.positions[b], r = mesh.positions[c];
    return std::array{p.x, p.y, p.z, q.x, q.y, q.z, r.x, r.y, r.z};
  };
  std::vector<std::array<float, 9>> result;
  for (const auto& [a, b, c] : mesh.triangles) {
    result.push_back(std::min({written(a, b, c), written(b, c, a), written(c, a, b)}));
  }
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace geosis::test
