#include "engine/codec/ply.h"

#include <bit>
#include <cstdint>

#include "engine/codec/stream_buffer.h"

namespace geosis {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY records are written as they lie in memory");

void write_header(StreamBuffer& out, const IndexedMesh& mesh) {
  out.append("ply\nformat binary_little_endian 1.0\nelement vertex ");
  out.append_decimal(mesh.positions.size());
  out.append("\nproperty double x\nproperty double y\nproperty double z\nelement face ");
  out.append_decimal(mesh.triangles.size());
  out.append("\nproperty list uchar int vertex_indices\nend_header\n");
}

}  // namespace

Result<void> write_ply(std::ostream& stream, const IndexedMesh& mesh, const PositionMap& to_space) {
  StreamBuffer out(stream);
  write_header(out, mesh);
  for (const Vec3f position : mesh.positions) {
    const Vec3d index = to_double(position);
    out.append_raw(to_space ? to_space(index) : index);
  }
  for (const Triangle& triangle : mesh.triangles) {
    out.append_raw(std::uint8_t{3});
    out.append_raw(triangle);
  }
  return out.finish();
}

}  // namespace geosis
