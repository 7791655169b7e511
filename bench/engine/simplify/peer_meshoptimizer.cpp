#include <meshoptimizer.h>

#include "bench/engine/simplify/peers.h"

namespace geosis {

IndexedMesh simplify_with_meshoptimizer(const IndexedMesh& m0, std::size_t triangles) {
  constexpr float kAnyError = 1e9f;
  const auto* indices = reinterpret_cast<const unsigned*>(m0.triangles.data());
  std::vector<unsigned> out(3 * m0.triangles.size());
  out.resize(meshopt_simplify(out.data(), indices, out.size(), &m0.positions[0].x, m0.positions.size(), sizeof(Vec3f),
                              3 * triangles, kAnyError, 0, nullptr));
  IndexedMesh level{m0.positions, {}};
  for (std::size_t i = 0; i < out.size(); i += 3) {
    level.triangles.push_back({static_cast<std::int32_t>(out[i]), static_cast<std::int32_t>(out[i + 1]),
                               static_cast<std::int32_t>(out[i + 2])});
  }
  return level;
}

}  // namespace geosis
