#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "engine/mesh/indexed_mesh.h"

namespace geosis {

/// A scalar field over grid nodes (i, j, k); the body is where it is below zero.
using NodeField = std::function<double(int i, int j, int k)>;

/// Surface of the body on a grid of shape[0] x shape[1] x shape[2] nodes, by marching tetrahedra.
///
/// Vertices lie on the 1/64 lattice, at least one step from the nodes, so that no triangle is degenerate. Triangles
/// look outwards. Open where the body reaches the grid's faces. Triangles come in slabs of one i.
IndexedMesh mesh_field(std::array<int, 3> shape, const NodeField& field);

NodeField ball(Vec3d centre, double radius);
NodeField torus(Vec3d centre, double major, double minor);
NodeField gyroid(double period, double level);

/// A uniform random value in [-1, 1) at each node: every kind of cell, specks, thin bridges, many handles.
NodeField noise(std::uint64_t seed);

/// The field, but positive on the faces of the grid: closes the body there.
NodeField closed_on_faces(std::array<int, 3> shape, NodeField field);

}  // namespace geosis
