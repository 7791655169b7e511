#include "engine/codec/obj.h"

#include "engine/codec/stream_buffer.h"

namespace geosis {

Result<void> write_obj(std::ostream& stream, const IndexedMesh& mesh, const PositionMap& to_space) {
  StreamBuffer out(stream);
  for (const Vec3f position : mesh.positions) {
    const Vec3d index = to_double(position);
    const Vec3d p = to_space ? to_space(index) : index;
    out.append("v");
    for (int axis = 0; axis < 3; ++axis) {
      out.append(" ");
      out.append_decimal(p[axis]);
    }
    out.append("\n");
  }
  for (const Triangle& triangle : mesh.triangles) {
    out.append("f");
    for (const std::int32_t v : triangle) {
      out.append(" ");
      out.append_decimal(std::int64_t{v} + 1);
    }
    out.append("\n");
  }
  return out.finish();
}

}  // namespace geosis
