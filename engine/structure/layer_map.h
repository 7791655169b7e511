#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/structure/layer_paths.h"
#include "engine/volume/grid.h"

namespace geosis {

/// From rectified positions (inline, crossline, layer) to the samples' (inline, crossline, sample), trilinear in each
/// cell of a structural grid, and cut to a region: layers that leave it run along its top or bottom.
///
/// Positions on the 1/64 lattice stay on it; on lines through nodes, where crossings lie, nothing is rounded.
class LayerMap {
 public:
  /// paths    kept by reference.
  LayerMap(const LayerPaths& paths, const GridBox& region) : paths_(paths), region_(region) {}

  const LayerPaths& paths() const { return paths_; }
  const GridBox& region() const { return region_; }

  /// The sample at a node.
  std::int32_t sample_at(std::int32_t i, std::int32_t j, std::int32_t layer) const;
  Vec3f to_samples(Vec3f position) const;

 private:
  const LayerPaths& paths_;
  GridBox region_;
};

/// All positions, each for itself. cost: eight looks at paths each.
std::vector<Vec3f> to_samples(const LayerMap& map, std::span<const Vec3f> positions, int threads);

}  // namespace geosis
