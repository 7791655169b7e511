#pragma once

#include <string>

#include "engine/isosurface/extract.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/scalar_field.h"

namespace geosis::test {

/// The body's surface of the whole field; a failure of the running test, and an empty mesh, when extraction fails.
IndexedMesh extract_surface(const ScalarField& field, IsoRange range, BodyMode mode, bool cap = true, int threads = 1);

/// What a law says of one field.
struct Verdict {
  std::string broken;   ///< which law is broken and how, for the reader; empty when all hold
  bool decided = true;  ///< false: the field's topology has more than one right answer, so it was not compared
};

/// The capped surface is closed, manifold, on the lattice, and oriented outwards where the body is not thin, with the
/// oracle's Euler characteristic and number of components. Without missing samples no two vertices share a position.
Verdict judge_closed_surface(const ScalarField& field, IsoRange range, BodyMode mode);

/// The surface without caps is manifold with boundary and has the oracle's Euler characteristic.
Verdict judge_open_surface(const ScalarField& field, IsoRange range, BodyMode mode);

/// The same two, with an oracle that counts exactly: decided for all samples.
Verdict judge_closed_surface_exactly(const ScalarField& field, IsoRange range, BodyMode mode);
Verdict judge_open_surface_exactly(const ScalarField& field, IsoRange range, BodyMode mode);

/// Encoded in several parts and decoded, the capped surface keeps its topology, its volume and its vertex positions.
Verdict judge_decoded_surface(const ScalarField& field, IsoRange range, BodyMode mode);

/// One thread and several give the same mesh, index by index.
Verdict judge_threads(const ScalarField& field, IsoRange range, BodyMode mode);

}  // namespace geosis::test
