#pragma once

#include <array>
#include <cstdint>

#include "engine/isosurface/cell_decisions.h"
#include "engine/isosurface/extract.h"

namespace geosis {

/// One of the surfaces that bound the body: {f = low}, {f = high}, or {g = 0} of the sampled mode.
struct Sheet {
  enum class Kind { low_end, high_end, product };

  Kind kind = Kind::low_end;
  float low = 0, high = 0;

  /// The body lies above low_end and product (g >= 0), below high_end.
  bool body_is_above() const { return kind != Kind::high_end; }
  /// Values and level that decide faces and interior of a cell.
  CellValues cell_values(const std::array<float, 8>& samples) const;
  /// Lattice step (1..63) of the crossing on an edge, from its lower node; f0 and f1 are its ends' samples.
  int crossing_step(float f0, float f1) const;
};

/// The sheets of a range: none for an infinite end.
struct BodySheets {
  int count = 0;
  std::array<Sheet, 2> sheet{};
};

BodySheets sheets_of(IsoRange range, BodyMode mode);

/// Moves the steps of two sheets that cross the same edge apart, keeping their order: at least one step between them.
/// `first` is the one nearer to the lower node.
void separate_steps(int& first, int& second);

}  // namespace geosis
