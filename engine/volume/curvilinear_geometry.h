#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/base/result.h"
#include "engine/base/vec3.h"
#include "engine/volume/geometry.h"
#include "engine/volume/grid.h"

namespace geosis {

/// A line that carries the nodes of one trace.
struct Pillar {
  Vec3d top, bottom;
};

/// A grid whose nodes lie anywhere: a position each, trilinear between them.
///
/// Positions are kept as float32 from a common origin: to a millimetre over ten kilometres.
class CurvilinearGeometry final : public GridGeometry {
 public:
  /// Cells that are turned inside out beside the others may make up this share of all.
  static constexpr double kMostFolded = 0.01;

  /// nodes    shape.count() world positions, sample fastest; at least two nodes an axis.
  /// errors   malformed_input: another number of nodes, one that is not finite, more folded cells than kMostFolded; the
  ///          message says where.
  static Result<CurvilinearGeometry> from_nodes(GridShape shape, std::span<const Vec3d> nodes);

  /// pillars  one a trace, (inlines, crosslines), crossline fastest; its ends differ in depth.
  /// depths   shape.count() depths (z), sample fastest: where on its pillar each node is, beyond the ends too.
  /// errors   as from_nodes; malformed_input: a pillar whose ends lie at one depth.
  static Result<CurvilinearGeometry> from_pillars(GridShape shape, std::span<const Pillar> pillars,
                                                  std::span<const double> depths);

  /// Beyond the grid: the outermost cells go on.
  Vec3d map(Vec3d index) const override;
  const std::array<double, 16>* affine() const override { return nullptr; }
  bool mirrored() const override { return mirrored_; }

  GridShape shape() const { return shape_; }
  double folded_share() const { return folded_share_; }

 private:
  CurvilinearGeometry(GridShape shape, std::span<const Vec3d> nodes);
  Vec3d node(std::int32_t i, std::int32_t j, std::int32_t k) const;
  double turn_of(std::int32_t i, std::int32_t j, std::int32_t k, int corner) const;
  Result<void> find_handedness();

  GridShape shape_;
  Vec3d origin_;
  std::vector<Vec3f> nodes_;  ///< from origin_
  bool mirrored_ = false;
  double folded_share_ = 0;
};

}  // namespace geosis
