#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "engine/base/result.h"
#include "engine/isosurface/body_sheets.h"
#include "engine/isosurface/cell_presence.h"
#include "engine/isosurface/extract.h"
#include "engine/isosurface/row_masks.h"
#include "engine/volume/brick_layout.h"
#include "engine/volume/bricks.h"

namespace geosis {

/// Nodes of a brick that lie in the region, in the brick's numbering, and the layers it shares with other bricks.
struct LocalBox {
  std::array<int, 3> first{}, last{};
  std::array<bool, 3> has_previous{}, has_next{};  ///< another brick of the region begins or goes on here
};

/// origin   the brick's first node; extent: its nodes. The brick has a node in the region.
LocalBox clip_to_region(GridIndex origin, GridShape extent, const GridBox& region);

/// Calls visit(n) for every bit n that is set, lowest first.
template <class Visit>
void each_bit(std::uint64_t bits, Visit&& visit) {
  for (; bits != 0; bits &= bits - 1) visit(std::countr_zero(bits));
}

/// One brick as the mesher asks it: signs of whole rows as bits, samples, and the cells that are there.
///
/// Nodes and cells are numbered (a, b, c) from the brick's first node. Loading again reuses the memory.
class BrickField {
 public:
  BrickField(const BrickedVolume& volume, IsoRange range, const ExtractOptions& options);

  /// errors   malformed_input: damaged brick, this one or one beside it.
  Result<void> load(std::size_t brick);

  const BodySheets& sheets() const { return sheets_; }
  const LocalBox& box() const { return box_; }
  const CellPresence& presence() const { return presence_; }
  GridIndex origin() const { return view_.first; }

  /// The domain's border passes through or beside the brick, and is to be capped.
  bool needs_cap() const { return capped_ && !presence_.is_complete(); }

  /// Rows of nodes, bit c for node (a, b, c): above the sheet's level; inside the body.
  std::uint64_t above(int sheet, int a, int b) const;
  std::uint64_t inside(int a, int b) const { return row(a, b).at_least & ~row(a, b).greater; }
  /// Edges along `axis` in the region that start in row (a, b) and are crossed by the sheet.
  std::uint64_t crossed(int sheet, int axis, int a, int b) const;
  /// Edges along `axis` in the region that start in row (a, b) and lie wholly inside the body.
  std::uint64_t covered(int axis, int a, int b) const;
  /// Nodes (cells) of a row that lie in the region.
  std::uint64_t nodes_in_region() const { return bits_between(box_.first[2], box_.last[2]); }
  std::uint64_t cells_in_region() const { return bits_between(box_.first[2], box_.last[2] - 1); }

  float sample(int a, int b, int c) const { return *samples_from(a, b, c); }
  /// The row's samples from that node on.
  const float* samples_from(int a, int b, int c) const {
    return view_.samples + ((static_cast<std::size_t>(a) * view_.extent.crosslines + b) * view_.extent.samples + c);
  }
  /// Corners of a cell above the sheet's level, as bits.
  std::uint8_t corners_above(int sheet, int a, int b, int c) const;
  CellValues cell_values(int sheet, int a, int b, int c) const;

 private:
  static std::uint64_t bits_between(int first, int last) {
    if (first > last) return 0;
    return (~std::uint64_t{0} >> (63 - last)) & (~std::uint64_t{0} << first);
  }
  const RowMasks& row(int a, int b) const { return masks_[static_cast<std::size_t>(a) * kBrickSamples + b]; }
  std::uint64_t edges_in_region(int axis) const { return axis == 2 ? cells_in_region() : nodes_in_region(); }

  const BrickedVolume& volume_;
  const BrickLayout layout_;
  const IsoRange range_;
  const GridBox region_;
  const bool capped_;
  const BodySheets sheets_;

  BrickView view_;
  LocalBox box_;
  CellPresence presence_;
  std::vector<RowMasks> masks_;
};

}  // namespace geosis
