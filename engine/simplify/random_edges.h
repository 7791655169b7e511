#pragma once

#include <cstdint>
#include <vector>

#include "engine/simplify/rings.h"

namespace geosis {

/// Draws random edges of a window: the same ones for the same seed.
class RandomEdges {
 public:
  explicit RandomEdges(std::uint64_t seed) : state_(seed) {}

  /// Edges begin at the vertices that were added.
  void add(LocalVertex v) { vertices_.push_back(v); }

  /// An edge from u to v; false when no vertex has triangles any more.
  bool draw(const Rings& rings, LocalVertex& u, LocalVertex& v) {
    while (!vertices_.empty()) {
      LocalVertex& drawn = vertices_[below(vertices_.size())];
      const auto ring = rings.of(drawn);
      if (ring.empty()) {  // merged meanwhile
        drawn = vertices_.back();
        vertices_.pop_back();
        continue;
      }
      u = drawn;
      const RingTriangle t = ring[below(ring.size())];
      v = (next() & 1) != 0 ? t.a : t.b;
      return true;
    }
    return false;
  }

 private:
  /// SplitMix64 (Steele, Lea & Flood 2014).
  std::uint64_t next() {
    std::uint64_t x = state_ += 0x9e3779b97f4a7c15u;
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return x ^ x >> 31;
  }
  std::size_t below(std::size_t size) { return static_cast<std::size_t>((next() >> 32) * size >> 32); }

  std::uint64_t state_;
  std::vector<LocalVertex> vertices_;
};

}  // namespace geosis
