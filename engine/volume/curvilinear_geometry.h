#pragma once

#include <array>
#include <memory>
#include <span>
#include <utility>

#include "engine/base/result.h"
#include "engine/base/vec3.h"
#include "engine/volume/geometry.h"
#include "engine/volume/grid.h"
#include "engine/volume/node_offsets.h"
#include "engine/volume/node_report.h"

namespace geosis {

/// A grid whose nodes lie anywhere: a position each, trilinear between them.
///
/// Positions are kept as float32 from a common origin: to a millimetre over ten kilometres.
class CurvilinearGeometry final : public GridGeometry {
 public:
  /// nodes    shape.count() world positions, sample fastest; at least two nodes an axis.
  /// errors   malformed_input: another number of nodes, one that is not finite, more folded cells than kMostFolded; the
  ///          message says where.
  static Result<CurvilinearGeometry> from_nodes(GridShape shape, std::span<const Vec3d> nodes);

  /// pillars  one a trace, (inlines, crosslines), crossline fastest; its ends differ in depth.
  /// depths   shape.count() depths (z), sample fastest: where on its pillar each node is, beyond the ends too.
  /// errors   as from_nodes; malformed_input: a pillar whose ends lie at one depth.
  static Result<CurvilinearGeometry> from_pillars(GridShape shape, std::span<const Pillar> pillars,
                                                  std::span<const double> depths);

  /// Nodes that somebody else holds and has looked at: offsets from `origin`, in the bytes that `owner` keeps.
  CurvilinearGeometry(GridShape shape, Vec3d origin, std::span<const Vec3f> offsets, std::shared_ptr<const void> owner,
                      const NodeReport& report)
      : shape_(shape), origin_(origin), nodes_(offsets), owner_(std::move(owner)), report_(report) {}

  /// Beyond the grid: the outermost cells go on.
  Vec3d map(Vec3d index) const override;
  const std::array<double, 16>* affine() const override { return nullptr; }
  bool mirrored() const override { return report_.mirrored; }

  GridShape shape() const { return shape_; }
  const NodeReport& report() const { return report_; }

 private:
  Vec3d node(std::int32_t i, std::int32_t j, std::int32_t k) const;

  GridShape shape_;
  Vec3d origin_;
  std::span<const Vec3f> nodes_;  ///< from origin_
  std::shared_ptr<const void> owner_;
  NodeReport report_;
};

}  // namespace geosis
