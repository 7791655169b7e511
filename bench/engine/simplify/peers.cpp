#include "bench/engine/simplify/peers.h"

namespace geosis {

std::vector<Peer> peers() {
  std::vector<Peer> all;
#ifdef GEOSIS_HAVE_MESHOPTIMIZER
  all.push_back({"meshoptimizer", simplify_with_meshoptimizer, true});
#endif
#ifdef GEOSIS_HAVE_CGAL
  all.push_back({"CGAL Garland-Heckbert", simplify_with_garland_heckbert});
  all.push_back({"CGAL Lindstrom-Turk", simplify_with_lindstrom_turk});
#endif
#ifdef GEOSIS_HAVE_VTK
  all.push_back({"VTK quadric decimation", simplify_with_vtk});
#endif
  return all;
}

}  // namespace geosis
