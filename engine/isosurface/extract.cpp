#include "engine/isosurface/extract.h"

#include <vector>

#include "engine/isosurface/brick_mesher.h"
#include "engine/isosurface/brick_sweep.h"
#include "engine/isosurface/weld.h"
#include "engine/volume/brick_layout.h"

namespace geosis {
namespace {

/// Meshes bricks[n] into meshes[n].
struct MeshWorker {
  BrickMesher mesher;
  const std::vector<std::size_t>& bricks;
  std::vector<BrickMesh>& meshes;

  Result<void> operator()(std::size_t n) {
    auto mesh = mesher.mesh(bricks[n]);
    if (!mesh) return std::move(mesh).error();
    meshes[n] = std::move(mesh).value();
    return {};
  }
};

}  // namespace

Result<IndexedMesh> extract_body(const BrickedVolume& volume, IsoRange range, const ExtractOptions& options,
                                 Progress& progress) {
  if (auto checked = check_request(volume.shape(), range, options); !checked) return std::move(checked).error();
  const auto bricks = active_bricks(volume, range, options);
  std::vector<BrickMesh> meshes(bricks.size());
  auto swept = sweep_bricks(bricks.size(), options.threads, progress, [&] {
    return MeshWorker{BrickMesher(volume, range, options), bricks, meshes};
  });
  if (!swept) return std::move(swept).error();
  return weld_bricks(BrickLayout(volume.shape()), bricks, std::move(meshes), options.max_triangles, options.threads);
}

}  // namespace geosis
