#include "engine/isosurface/brick_field.h"

#include <algorithm>

namespace geosis {

LocalBox clip_to_region(GridIndex origin, GridShape extent, const GridBox& region) {
  LocalBox box;
  for (int axis = 0; axis < 3; ++axis) {
    box.first[axis] = std::max(region.first[axis] - origin[axis], 0);
    box.last[axis] = std::min(region.last[axis] - origin[axis], extent[axis] - 1);
    box.has_previous[axis] = region.first[axis] < origin[axis];
    box.has_next[axis] = region.last[axis] > origin[axis] + extent[axis] - 1;
  }
  return box;
}

BrickField::BrickField(const BrickedVolume& volume, IsoRange range, const ExtractOptions& options)
    : volume_(volume),
      layout_(volume.shape()),
      range_(range),
      region_(options.region),
      capped_(options.cap),
      sheets_(sheets_of(range, options.mode)),
      masks_(static_cast<std::size_t>(kBrickSamples) * kBrickSamples) {}

Result<void> BrickField::load(std::size_t brick) {
  auto view = volume_.brick(brick);
  if (!view) return std::move(view).error();
  view_ = *view;
  box_ = clip_to_region(view_.first, view_.extent, region_);
  const auto rows = static_cast<std::size_t>(view_.extent.crosslines),
             length = static_cast<std::size_t>(view_.extent.samples);
  for (int a = 0; a < view_.extent.inlines; ++a) {
    classify_rows(view_.samples + static_cast<std::size_t>(a) * rows * length, rows, length, range_.low, range_.high,
                  &masks_[static_cast<std::size_t>(a * kBrickSamples)]);
  }
  return presence_.load(volume_, layout_.place(brick), region_);
}

std::uint64_t BrickField::above(int sheet, int a, int b) const {
  switch (sheets_.sheet[sheet].kind) {
    case Sheet::Kind::low_end:
      return row(a, b).at_least;
    case Sheet::Kind::high_end:
      return row(a, b).greater;
    case Sheet::Kind::product:
      return inside(a, b);
  }
  return 0;
}

std::uint64_t BrickField::crossed(int sheet, int axis, int a, int b) const {
  const std::uint64_t here = above(sheet, a, b);
  const std::uint64_t there = axis == 0 ? above(sheet, a + 1, b) : axis == 1 ? above(sheet, a, b + 1) : here >> 1;
  return (here ^ there) & edges_in_region(axis);
}

std::uint64_t BrickField::covered(int axis, int a, int b) const {
  const std::uint64_t here = inside(a, b);
  const std::uint64_t there = axis == 0 ? inside(a + 1, b) : axis == 1 ? inside(a, b + 1) : here >> 1;
  return here & there & edges_in_region(axis);
}

std::uint8_t BrickField::corners_above(int sheet, int a, int b, int c) const {
  const auto two = [&](int i, int j) { return static_cast<unsigned>(above(sheet, a + i, b + j) >> c) & 3u; };
  return static_cast<std::uint8_t>(two(0, 0) | two(0, 1) << 2 | two(1, 0) << 4 | two(1, 1) << 6);
}

CellValues BrickField::cell_values(int sheet, int a, int b, int c) const {
  std::array<float, 8> samples{};
  for (int corner = 0; corner < 8; ++corner) {
    samples[corner] = sample(a + (corner >> 2), b + ((corner >> 1) & 1), c + (corner & 1));
  }
  return sheets_.sheet[sheet].cell_values(samples);
}

}  // namespace geosis
