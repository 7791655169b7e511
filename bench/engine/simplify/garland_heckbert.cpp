#include "bench/engine/simplify/garland_heckbert.h"

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_ratio_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_policies.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

namespace geosis {

using Kernel = CGAL::Simple_cartesian<double>;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;

IndexedMesh garland_heckbert(const IndexedMesh& m0, double ratio) {
  Surface surface;
  std::vector<Surface::Vertex_index> vertices;
  for (const Vec3f p : m0.positions) vertices.push_back(surface.add_vertex(Kernel::Point_3(p.x, p.y, p.z)));
  for (const auto& [a, b, c] : m0.triangles) surface.add_face(vertices[a], vertices[b], vertices[c]);
  CGAL::Surface_mesh_simplification::GarlandHeckbert_policies<Surface, Kernel> policies(surface);
  CGAL::Surface_mesh_simplification::Count_ratio_stop_predicate<Surface> stop(ratio);
  CGAL::Surface_mesh_simplification::edge_collapse(
      surface, stop, CGAL::parameters::get_cost(policies.get_cost()).get_placement(policies.get_placement()));
  surface.collect_garbage();
  IndexedMesh result;
  for (const auto v : surface.vertices()) {
    const auto& p = surface.point(v);
    result.positions.push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())});
  }
  for (const auto f : surface.faces()) {
    Triangle triangle;
    int k = 0;
    for (const auto v : CGAL::vertices_around_face(surface.halfedge(f), surface)) {
      triangle[k++] = static_cast<std::int32_t>(v);
    }
    result.triangles.push_back(triangle);
  }
  return result;
}

}  // namespace geosis
