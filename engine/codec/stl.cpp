#include "engine/codec/stl.h"

#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <limits>
#include <string>

#include "engine/codec/stream_buffer.h"

namespace geosis {
namespace {

static_assert(std::endian::native == std::endian::little, "STL records are written as they lie in memory");

constexpr std::size_t kHeaderBytes = 80;

/// Must not begin with "solid", by which readers know STL in text. All numbers fit whose exponent has two digits.
std::string header(Vec3d origin) {
  std::string text = "origin";
  for (int axis = 0; axis < 3; ++axis) {
    std::array<char, 32> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), origin[axis]).ptr;
    text += ' ';
    text.append(digits.data(), static_cast<std::size_t>(end - digits.data()));
  }
  text.resize(kHeaderBytes, ' ');
  return text;
}

Vec3f to_float(Vec3d p) {
  return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
}

Vec3f unit_normal(const std::array<Vec3d, 3>& corners) {
  const Vec3d normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
  const double length = norm(normal);
  return length > 0 ? to_float(normal * (1 / length)) : Vec3f{};
}

}  // namespace

Result<void> write_stl(std::ostream& stream, const IndexedMesh& mesh, const PositionMap& to_space, Vec3d origin) {
  if (mesh.triangles.size() > std::numeric_limits<std::uint32_t>::max()) {
    return Error{ErrorCode::limit_exceeded,
                 std::to_string(mesh.triangles.size()) + " triangles; STL holds at most 4294967295"};
  }
  StreamBuffer out(stream);
  out.append(header(origin));
  out.append_raw(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const Triangle& triangle : mesh.triangles) {
    std::array<Vec3d, 3> corners;
    for (int corner = 0; corner < 3; ++corner) {
      const Vec3d index = to_double(mesh.positions[triangle[corner]]);
      corners[corner] = (to_space ? to_space(index) : index) - origin;
    }
    out.append_raw(unit_normal(corners));
    for (const Vec3d& corner : corners) out.append_raw(to_float(corner));
    out.append_raw(std::uint16_t{0});
  }
  return out.finish();
}

}  // namespace geosis
