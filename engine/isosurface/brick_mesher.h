#pragma once

#include <cstddef>

#include "engine/base/result.h"
#include "engine/isosurface/brick_field.h"
#include "engine/isosurface/brick_mesh.h"
#include "engine/isosurface/brick_vertices.h"
#include "engine/isosurface/cap_face.h"
#include "engine/isosurface/extract.h"
#include "engine/isosurface/mc33_tables.h"
#include "engine/isosurface/patch_geometry.h"

namespace geosis {

/// Meshes brick after brick with one set of buffers. One object a thread.
class BrickMesher {
 public:
  BrickMesher(const BrickedVolume& volume, IsoRange range, const ExtractOptions& options);
  BrickMesher(const BrickMesher&) = delete;
  BrickMesher& operator=(const BrickMesher&) = delete;

  /// errors   malformed_input: damaged brick.
  /// cost     one pass over the brick's samples, then O(active cells).
  Result<BrickMesh> mesh(std::size_t brick);

  /// The brick that was meshed last.
  const BrickField& field() const { return field_; }

 private:
  void fill_cells(int a, int b);
  void fill_cell(int sheet, int a, int b, int c);
  Mc33Patch patch_of(int sheet, int a, int b, int c);
  Mc33Patch tunnel_patch(const Mc33Tunnel& tunnel, int sheet, int a, int b, int c);
  CellPoints crossings_of(int sheet, int a, int b, int c) const;
  void cap_cells(int a, int b);
  void cap_cell(int face, int a, int b, int c);
  CapFace cap_face_of(int face, int a, int b, int c) const;
  void add_triangle(std::int32_t p, std::int32_t q, std::int32_t r, bool turned);

  const bool mirrored_;
  BrickField field_;
  BrickMesh mesh_;
  BrickVertices vertices_;
  std::int32_t inner_vertex_ = -1;  ///< of the cell being filled
};

}  // namespace geosis
