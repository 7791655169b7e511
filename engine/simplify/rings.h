#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace geosis {

/// Vertex of a window. 16 bits, so that a window has at most 65,536 of them and a one-ring fits in half a cache line.
using LocalVertex = std::uint16_t;
using LocalTriangle = std::array<LocalVertex, 3>;

/// In the one-ring of v: the triangle (v, a, b).
struct RingTriangle {
  LocalVertex a, b;
};

/// The one-rings of a window's vertices: for each vertex its triangles, in no order.
class Rings {
 public:
  void build(std::size_t vertices, std::span<const LocalTriangle> triangles);

  int degree(LocalVertex v) const { return places_[v].degree; }
  std::span<const RingTriangle> of(LocalVertex v) const { return {&triangles_[places_[v].first], places_[v].degree}; }

  /// Has v's ring fetched into the cache.
  void prefetch(LocalVertex v) const { __builtin_prefetch(&triangles_[places_[v].first]); }

  /// v's triangles, to be read and written eight at a time: whatever lies behind the last one is there.
  RingTriangle* data(LocalVertex v) { return &triangles_[places_[v].first]; }
  const RingTriangle* data(LocalVertex v) const { return &triangles_[places_[v].first]; }

  /// Forgets v's triangles from `degree` on.
  void shorten(LocalVertex v, int degree) { places_[v].degree = static_cast<std::uint16_t>(degree); }

  /// Gives u the ring `merged` (which must not lie in this object) and leaves v without one.
  void merge(LocalVertex u, LocalVertex v, std::span<const RingTriangle> merged);

 private:
  struct Place {
    std::uint32_t first = 0;
    std::uint16_t degree = 0, room = 0;
  };
  // Rooms come in multiples of 4 triangles: whole vector registers, and freed ones fit again.
  static constexpr std::uint32_t kStep = 4;
  static constexpr std::uint32_t kPadding = 8;       // triangles behind all rooms
  static constexpr std::uint32_t kReusedRooms = 16;  // in steps; larger ones do not come back

  std::uint32_t allocate(std::uint32_t room);
  void release(const Place& place);

  std::vector<Place> places_;
  std::vector<RingTriangle> triangles_;
  std::array<std::vector<std::uint32_t>, kReusedRooms> free_;
};

}  // namespace geosis
