#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "engine/isosurface/brick_field.h"
#include "engine/isosurface/brick_mesh.h"
#include "engine/mesh/lattice_triangles.h"

namespace geosis {

/// Makes the vertices of one brick, plane of nodes by plane, and knows their numbers while the cells between two planes
/// are filled. No hash map: a number is looked up by its edge's place in the plane.
///
/// A vertex lies on a crossed edge (one for each sheet), on a node of the domain's border inside the body, or in the
/// middle of a contact edge that lies wholly inside the body; it exists if a cell around it does. Contacts get a copy
/// for each side (contacts.h).
class BrickVertices {
 public:
  /// What can lie on an edge: the crossing of sheet 0 or 1, or kMiddle.
  static constexpr int kMiddle = 2;

  BrickVertices(const BrickField& field, BrickMesh& mesh);

  /// Vertices in plane a, and on the edges from plane a to a + 1. Planes are made in rising order; two are remembered.
  void make_plane(int a);
  void make_between(int a);

  /// A vertex strictly inside the cell at (a, b, c), `steps` lattice steps from its corner 0; its number. Cells belong
  /// to one brick, so no other brick has it.
  std::int32_t add_inside(int a, int b, int c, const LatticePoint& steps);

  /// Number of the vertex of that kind on an edge of the cell at (a, b, c).
  std::int32_t on_edge(int kind, int edge, int a, int b, int c) const;
  /// Number of the vertex on a corner of the cell at (a, b, c), as its border face with that normal axis uses it.
  std::int32_t on_corner(int corner, int normal, int a, int b, int c) const;

 private:
  static constexpr std::size_t kPlane = static_cast<std::size_t>(kBrickSamples) * kBrickSamples;
  /// Vertex numbers of the edges along one axis that start in one plane, by kind; set where the vertex exists.
  using EdgeNumbers = std::array<std::array<std::int32_t, kPlane>, 3>;
  struct PlaneNumbers {
    EdgeNumbers along_j, along_k;
    std::array<std::int32_t, kPlane> node;
  };

  static std::size_t place(int b, int c) { return static_cast<std::size_t>(b) * kBrickSamples + c; }
  PlaneNumbers& plane(int a) { return (*planes_)[a & 1]; }
  const PlaneNumbers& plane(int a) const { return (*planes_)[a & 1]; }

  void make_row(EdgeNumbers& numbers, int axis, int a, int b);
  void make_edge(EdgeNumbers& numbers, int axis, int a, int b, int c, unsigned crossed);
  std::array<int, 2> crossing_steps(int axis, int a, int b, int c, unsigned crossed) const;
  void make_nodes(int a, int b);
  std::int32_t add_on_edge(int axis, int a, int b, int c, int step, bool has_copy);
  std::int32_t append(int axis, int a, int b, int c, int step);

  const BrickField& field_;
  BrickMesh& mesh_;
  std::unique_ptr<std::array<PlaneNumbers, 2>> planes_;
  std::unique_ptr<EdgeNumbers> between_;
};

}  // namespace geosis
