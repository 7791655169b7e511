#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_ratio_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_policies.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include "bench/engine/simplify/peers.h"

namespace geosis {
namespace {

namespace SMS = CGAL::Surface_mesh_simplification;
using Kernel = CGAL::Simple_cartesian<double>;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;

Surface to_cgal(const IndexedMesh& m0) {
  Surface surface;
  std::vector<Surface::Vertex_index> vertices;
  for (const Vec3f p : m0.positions) vertices.push_back(surface.add_vertex(Kernel::Point_3(p.x, p.y, p.z)));
  for (const auto& [a, b, c] : m0.triangles) surface.add_face(vertices[a], vertices[b], vertices[c]);
  return surface;
}

IndexedMesh from_cgal(Surface& surface) {
  surface.collect_garbage();
  IndexedMesh mesh;
  for (const auto v : surface.vertices()) {
    const auto& p = surface.point(v);
    mesh.positions.push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())});
  }
  for (const auto f : surface.faces()) {
    Triangle triangle;
    int k = 0;
    for (const auto v : CGAL::vertices_around_face(surface.halfedge(f), surface)) {
      triangle[k++] = static_cast<std::int32_t>(v);
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

/// CGAL stops at a share of the edges, of which there are three for two triangles.
SMS::Count_ratio_stop_predicate<Surface> stop_at(const IndexedMesh& m0, std::size_t triangles) {
  return {static_cast<double>(triangles) / static_cast<double>(m0.triangles.size())};
}

}  // namespace

IndexedMesh simplify_with_garland_heckbert(const IndexedMesh& m0, std::size_t triangles) {
  Surface surface = to_cgal(m0);
  SMS::GarlandHeckbert_policies<Surface, Kernel> policies(surface);
  SMS::edge_collapse(surface, stop_at(m0, triangles),
                     CGAL::parameters::get_cost(policies.get_cost()).get_placement(policies.get_placement()));
  return from_cgal(surface);
}

IndexedMesh simplify_with_lindstrom_turk(const IndexedMesh& m0, std::size_t triangles) {
  Surface surface = to_cgal(m0);
  SMS::edge_collapse(surface, stop_at(m0, triangles),
                     CGAL::parameters::get_cost(SMS::LindstromTurk_cost<Surface>())
                         .get_placement(SMS::LindstromTurk_placement<Surface>()));
  return from_cgal(surface);
}

}  // namespace geosis
