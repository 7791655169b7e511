// Writes a small level in every form that the codec has, for readers that are not ours: write_level_files FOLDER.
// Its vertices carry what level_files_test.mjs computes from their positions.

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

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

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: write_level_files FOLDER\n");
    return 2;
  }
  const geosis::IndexedMesh torus = geosis::test::torus({32, 32, 32}, 15, 6, 30, 20);
  const auto level = geosis::encode_level(torus, attributes_of(torus), {.max_part_triangles = 700});
  return level && write_parts(argv[1], *level) ? 0 : 1;
}
