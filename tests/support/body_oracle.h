#pragma once

#include <cstdint>

#include "engine/isosurface/extract.h"
#include "tests/support/scalar_field.h"

namespace geosis::test {

/// Topology that the surface of a body must have.
struct SurfaceTopology {
  bool decided = true;  ///< false: a saddle lies (nearly) on an end of the range, more than one answer is right
  std::int64_t euler = 0;
  std::int64_t components = 0;

  bool operator==(const SurfaceTopology&) const = default;
};

/// What the oracle counts with.
enum class Arithmetic {
  rounded,  ///< long double: quick; leaves saddles near an end of the range undecided, and for samples that differ by
            ///< more than its 64 bits may order two changes within a cell wrongly
  exact,    ///< rational numbers, about 100 times slower; always decided: the ends are moved outwards by an eps > 0 so
            ///< small that it decides ties alone (docs/adr/0007)
};

/// Topology of the closed surface of {low <= f <= high}, capped on the domain's border, split where the body only
/// touches itself. Knows nothing of meshes or case tables.
///
/// The open body `int` is a 3-manifold and its surface the boundary of that manifold (but voids that meet in one node
/// of the body stay apart: no surface has a tube without width), so
///   Euler characteristic of the surface = -2 chi_c(int), chi_c counted with compact supports;
///   components of the surface = components of int + components of the closed rest of space - 1.
/// chi_c adds up over open nodes, edges, faces and cells off the domain's border; in each it is chi_c of the whole
/// minus that of {f < low} and of {f > high}. Components come from those of the cells, joined across faces (int) and
/// at nodes (the rest).
///
/// cost     O(nodes); rounded: about a second for ten million, 20 bytes a node.
SurfaceTopology expected_surface(const ScalarField& field, IsoRange range, BodyMode mode,
                                 Arithmetic arithmetic = Arithmetic::rounded);

/// The same for the surface without caps: two-manifold with boundary, Euler characteristic only (components stays 0).
SurfaceTopology expected_open_surface(const ScalarField& field, IsoRange range, BodyMode mode,
                                      Arithmetic arithmetic = Arithmetic::rounded);

}  // namespace geosis::test
