#pragma once

#include <functional>
#include <string>
#include <vector>

#include "engine/mesh/indexed_mesh.h"

namespace geosis {

/// Another library's simplification, down to about that many triangles.
struct Peer {
  std::string name;
  std::function<IndexedMesh(const IndexedMesh& m0, std::size_t triangles)> simplify;
  bool on_lattice = false;  ///< it leaves vertices where they were
};

/// Those that were installed when the benchmarks were configured.
std::vector<Peer> peers();

IndexedMesh simplify_with_meshoptimizer(const IndexedMesh& m0, std::size_t triangles);
IndexedMesh simplify_with_garland_heckbert(const IndexedMesh& m0, std::size_t triangles);
IndexedMesh simplify_with_lindstrom_turk(const IndexedMesh& m0, std::size_t triangles);
IndexedMesh simplify_with_vtk(const IndexedMesh& m0, std::size_t triangles);

}  // namespace geosis
