#pragma once

#include <cstdint>
#include <vector>

#include "engine/mesh/components.h"
#include "engine/mesh/indexed_mesh.h"
#include "engine/simplify/build_lods.h"

namespace geosis {

/// The components of M0 by size, and which of them levels have dropped.
class Specks {
 public:
  /// cost   O(triangles); 8 bytes a vertex.
  explicit Specks(const IndexedMesh& m0);

  /// Drops what is small enough, but never the largest component: no level is empty. Returns whether that is anything
  /// new.
  bool drop(const DropSpecks& limits);

  bool is_dropped(std::int32_t vertex_of_m0) const { return dropped_[components_.of_vertex[vertex_of_m0]]; }
  std::int64_t dropped() const { return dropped_count_; }

 private:
  struct Size {
    double volume = 0;  // six times the signed volume
    Vec3f low, high;
    bool is_closed = true;
  };

  Components components_;
  std::vector<Size> sizes_;
  std::vector<std::uint8_t> dropped_;
  std::int64_t dropped_count_ = 0;
};

}  // namespace geosis
