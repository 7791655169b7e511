#pragma once

#include <cstdint>
#include <vector>

#include "engine/simplify/buffer.h"
#include "engine/simplify/partition.h"
#include "engine/simplify/watch.h"
#include "engine/simplify/working_mesh.h"

namespace geosis {

/// The vertices of M0 that the first pass locks, with what they start with. A window does not see all triangles of
/// such a vertex, so they are looked at before.
class LockedStars {
 public:
  /// mesh   before its first pass.
  LockedStars(const WorkingMesh& mesh, Partition& partition, int threads, const Watch& watch);

  /// False: it was cancelled, and there is nothing to be read.
  bool is_made() const { return is_made_; }
  /// False if the triangles around one of them are not a fan.
  bool is_manifold() const { return is_manifold_; }

  /// place   of a locked vertex.
  const WorkingVertex& at(std::size_t place) const { return vertices_[slot_[place]]; }

 private:
  struct Pair {
    std::int32_t a, b;  // places
  };

  void count(Partition& partition, int threads);
  void fill(Partition& partition, int threads);
  void start(const WorkingMesh& mesh, const Partition& partition, int threads);

  Buffer<std::int32_t> slot_;         // place -> number of the locked vertex
  std::vector<std::int32_t> places_;  // number -> place
  std::vector<std::uint32_t> first_;  // (locked vertices + 1) into pairs_
  Buffer<Pair> pairs_;
  Buffer<WorkingVertex> vertices_;
  bool is_manifold_ = true, is_made_ = false;
};

}  // namespace geosis
