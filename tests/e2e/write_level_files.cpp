// Writes a small level in every form that the codec has, for readers that are not ours: write_level_files FOLDER.
// Its vertices carry what level_files_test.mjs computes from their positions.

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "engine/codec/glb.h"
#include "engine/codec/level_codec.h"
#include "tests/support/lattice_meshes.h"

namespace {

using geosis::kLatticeStepsPerVoxel;

geosis::VertexAttributes attributes_of(const geosis::IndexedMesh& mesh) {
  geosis::VertexAttributes attributes;
  for (const geosis::Vec3f p : mesh.positions) {
    attributes.reliability.push_back(static_cast<std::uint8_t>(static_cast<int>(p.x * kLatticeStepsPerVoxel) % 256));
    attributes.body.push_back(static_cast<std::uint32_t>(p.y * kLatticeStepsPerVoxel));
    attributes.value.push_back(p.z < 32 ? std::numeric_limits<float>::quiet_NaN() : -p.z / 3);
  }
  return attributes;
}

bool write_parts(const std::filesystem::path& folder, const geosis::EncodedLevel& level) {
  for (std::size_t part = 0; part < level.parts.size(); ++part) {
    const auto& bytes = level.parts[part].bytes;
    std::ofstream out(folder / ("torus." + std::to_string(part) + ".drc"), std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!out) return false;
  }
  return true;
}

std::vector<geosis::Vec3f> normals_of(const geosis::IndexedMesh& mesh) {
  std::vector<geosis::Vec3f> normals;
  for (const geosis::Vec3f p : mesh.positions) {
    const geosis::Vec3f arm = p - geosis::Vec3f{32, 32, 32};
    normals.push_back(arm * (1 / norm(arm)));
  }
  return normals;
}

/// A survey turned on the map, west of its origin, and one whose inlines and crosslines are not at right angles.
const geosis::EncodeOptions kTurned = {
    .transform = {15, 10, 0, 6'543'210.7, 20, -7.5, 0, 432'100.1, 0, 0, 4, -5, 0, 0, 0, 1}};
const geosis::EncodeOptions kSheared = {
    .transform = {25, 3, 0, 6'543'210.7, 0, 12.5, 0, 432'100.1, 0, 0, 4, -5, 0, 0, 0, 1}};

/// Out of the body in the space of a mirroring transform, as the codec's callers have it.
geosis::IndexedMesh turned_round(geosis::IndexedMesh mesh) {
  for (geosis::Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

bool write_glbs(const std::filesystem::path& folder, const geosis::IndexedMesh& mesh) {
  auto attributes = attributes_of(mesh);
  attributes.normal = normals_of(mesh);
  std::ofstream turned(folder / "turned.glb", std::ios::binary), sheared(folder / "sheared.glb", std::ios::binary);
  return write_glb(turned, turned_round(mesh), {}, kTurned) && write_glb(sheared, mesh, attributes, kSheared);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: write_level_files FOLDER\n");
    return 2;
  }
  const geosis::IndexedMesh torus = geosis::test::torus({32, 32, 32}, 15, 6, 30, 20);
  const auto level = geosis::encode_level(torus, attributes_of(torus), {.max_part_triangles = 700});
  return level && write_parts(argv[1], *level) && write_glbs(argv[1], torus) ? 0 : 1;
}
