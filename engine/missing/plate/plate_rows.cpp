#include "engine/missing/plate/plate_rows.h"

#include <cassert>

namespace geosis {

constexpr std::array<PlateOffset, kPlateReach> kOffsets = {{
    {0, 0, 0},  {-1, 0, 0}, {1, 0, 0},  {0, -1, 0},  {0, 1, 0},   {0, 0, -1}, {0, 0, 1},  {-2, 0, 0}, {2, 0, 0},
    {0, -2, 0}, {0, 2, 0},  {0, 0, -2}, {0, 0, 2},   {-1, -1, 0}, {-1, 1, 0}, {1, -1, 0}, {1, 1, 0},  {-1, 0, -1},
    {-1, 0, 1}, {1, 0, -1}, {1, 0, 1},  {0, -1, -1}, {0, -1, 1},  {0, 1, -1}, {0, 1, 1},
}};
const std::array<PlateOffset, kPlateReach> kPlateOffsets = kOffsets;

namespace {

/// One term of the energy that holds the node: factor * (sum of coefficient * value)^2. Member 0 is the node itself.
struct Stencil {
  int axis_a = 0, axis_b = 0;  // equal: a second difference
  int members = 0;
  std::array<int, 4> member{};
  std::array<int, 4> coefficient{};
  std::uint32_t nodes = 0;
};

int number_of(std::array<int, 3> offset) {
  for (int n = 0; n < kPlateReach; ++n)
    if (kOffsets[n].i == offset[0] && kOffsets[n].j == offset[1] && kOffsets[n].k == offset[2]) return n;
  assert(false);
  return 0;
}

void add_member(Stencil& stencil, std::array<int, 3> offset, int coefficient) {
  const int number = number_of(offset);
  stencil.member[stencil.members] = number;
  stencil.coefficient[stencil.members] = coefficient;
  stencil.nodes |= 1u << number;
  ++stencil.members;
}

/// The second difference on the axis whose middle lies `shift` steps from the node.
Stencil second_difference(int axis, int shift) {
  Stencil stencil{.axis_a = axis, .axis_b = axis};
  add_member(stencil, {0, 0, 0}, shift == 0 ? -2 : 1);
  for (int step = shift - 1; step <= shift + 1; ++step) {
    if (step == 0) continue;
    std::array<int, 3> offset{};
    offset[axis] = step;
    add_member(stencil, offset, step == shift ? -2 : 1);
  }
  return stencil;
}

/// The mixed difference over the face that the node and its diagonal neighbour span.
Stencil mixed_difference(int axis_a, int axis_b, int step_a, int step_b) {
  Stencil stencil{.axis_a = axis_a, .axis_b = axis_b};
  std::array<int, 3> a{}, b{}, both{};
  a[axis_a] = both[axis_a] = step_a;
  b[axis_b] = both[axis_b] = step_b;
  add_member(stencil, {0, 0, 0}, 1);
  add_member(stencil, a, -1);
  add_member(stencil, b, -1);
  add_member(stencil, both, 1);
  return stencil;
}

const std::vector<Stencil>& stencils_of_a_node() {
  static const std::vector<Stencil> kAll = [] {
    std::vector<Stencil> stencils;
    for (int axis = 0; axis < 3; ++axis)
      for (int shift = -1; shift <= 1; ++shift) stencils.push_back(second_difference(axis, shift));
    for (int a = 0; a < 3; ++a)
      for (int b = a + 1; b < 3; ++b)
        for (const int step_a : {-1, 1})
          for (const int step_b : {-1, 1}) stencils.push_back(mixed_difference(a, b, step_a, step_b));
    return stencils;
  }();
  return kAll;
}

PlateRow make_row(std::uint32_t available, Vec3d weights) {
  PlateRow row{};
  for (const Stencil& stencil : stencils_of_a_node()) {
    if ((available & stencil.nodes) != stencil.nodes) continue;
    const double factor =
        (stencil.axis_a == stencil.axis_b ? 1 : 2) * weights[stencil.axis_a] * weights[stencil.axis_b];
    for (int m = 0; m < stencil.members; ++m)
      row[stencil.member[m]] += factor * (stencil.coefficient[0] * stencil.coefficient[m]);
  }
  return row;
}

}  // namespace

std::array<std::ptrdiff_t, kPlateReach> plate_strides(std::ptrdiff_t plane, std::ptrdiff_t row) {
  std::array<std::ptrdiff_t, kPlateReach> strides{};
  for (int n = 0; n < kPlateReach; ++n) strides[n] = kOffsets[n].i * plane + kOffsets[n].j * row + kOffsets[n].k;
  return strides;
}

PlateNeighbours::PlateNeighbours(const GapBox& gap)
    : gap_(gap),
      strides_(plate_strides(std::ptrdiff_t{gap.samples.shape.crosslines} * gap.samples.shape.samples,
                             gap.samples.shape.samples)) {}

PlateSurroundings PlateNeighbours::at(std::int32_t i, std::int32_t j, std::int32_t k) const {
  const GridShape shape = gap_.samples.shape;
  const auto inside = [](std::int32_t at, std::int32_t count) { return at >= 2 && at < count - 2; };
  const bool interior = inside(i, shape.inlines) && inside(j, shape.crosslines) && inside(k, shape.samples);
  const NodeState* here = gap_.state.data() + gap_.samples.at(i, j, k);
  PlateSurroundings found;
  for (int n = 0; n < kPlateReach; ++n) {
    if (!interior) {
      const std::int32_t a = i + kOffsets[n].i, b = j + kOffsets[n].j, c = k + kOffsets[n].k;
      if (a < 0 || b < 0 || c < 0 || a >= shape.inlines || b >= shape.crosslines || c >= shape.samples) continue;
    }
    const NodeState state = here[strides_[n]];
    found.available |= static_cast<std::uint32_t>(state != NodeState::absent) << n;
    found.wanted |= static_cast<std::uint32_t>(state == NodeState::wanted) << n;
  }
  return found;
}

PlateRows::PlateRows(Vec3d weights) : weights_(weights) {
  number(kWholePlate);
}

std::uint32_t PlateRows::number(std::uint32_t available) {
  if (available == kWholePlate && !rows_.empty()) return 0;
  const auto [entry, is_new] = numbers_.try_emplace(available, static_cast<std::uint32_t>(rows_.size()));
  if (is_new) rows_.push_back(make_row(available, weights_));
  return entry->second;
}

}  // namespace geosis
