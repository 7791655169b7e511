#include "engine/codec/ply.h"

#include <bit>
#include <cstdint>
#include <string_view>
#include <vector>

#include "engine/codec/attribute_arrays.h"
#include "engine/codec/stream_buffer.h"

namespace geosis {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY records are written as they lie in memory");

template <class T>
constexpr std::string_view kPlyType = "";
template <>
constexpr std::string_view kPlyType<std::uint8_t> = "uchar";
template <>
constexpr std::string_view kPlyType<std::uint32_t> = "uint";
template <>
constexpr std::string_view kPlyType<float> = "float";

template <class T>
void declare(StreamBuffer& out, const char* name, const std::vector<T>& values) {
  if (values.empty()) return;
  out.append("\nproperty ");
  out.append(kPlyType<T>);
  out.append(" ");
  out.append(name);
}

void write_header(StreamBuffer& out, const IndexedMesh& mesh, const VertexAttributes& attributes) {
  out.append("ply\nformat binary_little_endian 1.0\nelement vertex ");
  out.append_decimal(mesh.positions.size());
  out.append("\nproperty double x\nproperty double y\nproperty double z");
  for_each_number([&](const char* name, auto array) { declare(out, name, attributes.*array); });
  out.append("\nelement face ");
  out.append_decimal(mesh.triangles.size());
  out.append("\nproperty list uchar int vertex_indices\nend_header\n");
}

}  // namespace

Result<void> write_ply(std::ostream& stream, const IndexedMesh& mesh, const VertexAttributes& attributes,
                       const PositionMap& to_space) {
  StreamBuffer out(stream);
  write_header(out, mesh, attributes);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3d index = to_double(mesh.positions[v]);
    out.append_raw(to_space ? to_space(index) : index);
    for_each_number([&](const char*, auto array) {
      if (!(attributes.*array).empty()) out.append_raw((attributes.*array)[v]);
    });
  }
  for (const Triangle& triangle : mesh.triangles) {
    out.append_raw(std::uint8_t{3});
    out.append_raw(triangle);
  }
  return out.finish();
}

}  // namespace geosis
