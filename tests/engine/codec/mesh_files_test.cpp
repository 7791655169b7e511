#include <array>
#include <cstdint>
#include <cstdio>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "engine/codec/obj.h"
#include "engine/codec/ply.h"
#include "engine/codec/stl.h"
#include "tests/support/lattice_meshes.h"

namespace geosis {
namespace {

const IndexedMesh kMesh = test::torus({32, 32, 32}, 15, 6, 12, 8);

/// Needs all digits of a double, beside an origin as large as a survey's.
Vec3d to_world(Vec3d p) {
  return {6'543'210.7 + p.x * 12.5 / 3, 432'100.1 - p.y / 7, p.z * 4};
}

const VertexAttributes kAttributes = [] {
  VertexAttributes attributes;
  for (std::size_t v = 0; v < kMesh.positions.size(); ++v) {
    attributes.reliability.push_back(static_cast<std::uint8_t>(v % 256));
    attributes.body.push_back(static_cast<std::uint32_t>(4'000'000'000 + v));
    attributes.value.push_back(static_cast<float>(v) / 3);
  }
  return attributes;
}();

struct MeshFile {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
};

template <class T>
T take(std::istream& stream) {
  T value{};
  stream.read(reinterpret_cast<char*>(&value), sizeof(T));
  return value;
}

MeshFile read_ply(std::istream& stream) {
  std::size_t vertices = 0, triangles = 0;
  for (std::string line; std::getline(stream, line) && line != "end_header";) {
    std::sscanf(line.c_str(), "element vertex %zu", &vertices);
    std::sscanf(line.c_str(), "element face %zu", &triangles);
  }
  MeshFile file;
  for (std::size_t v = 0; v < vertices; ++v) file.positions.push_back(take<Vec3d>(stream));
  for (std::size_t t = 0; t < triangles; ++t) {
    EXPECT_EQ(take<std::uint8_t>(stream), 3);
    file.triangles.push_back(take<Triangle>(stream));
  }
  EXPECT_TRUE(stream);
  EXPECT_EQ(stream.peek(), std::char_traits<char>::eof());
  return file;
}

MeshFile read_obj(std::istream& stream) {
  MeshFile file;
  for (std::string line; std::getline(stream, line);) {
    Vec3d p;
    Triangle t;
    if (std::sscanf(line.c_str(), "v %lf %lf %lf", &p.x, &p.y, &p.z) == 3) {
      file.positions.push_back(p);
    } else if (std::sscanf(line.c_str(), "f %d %d %d", &t[0], &t[1], &t[2]) == 3) {
      file.triangles.push_back({t[0] - 1, t[1] - 1, t[2] - 1});
    } else {
      ADD_FAILURE() << line;
    }
  }
  return file;
}

void expect_mapped_mesh(const MeshFile& file) {
  EXPECT_EQ(file.triangles, kMesh.triangles);
  ASSERT_EQ(file.positions.size(), kMesh.positions.size());
  for (std::size_t v = 0; v < file.positions.size(); ++v) {
    EXPECT_EQ(file.positions[v], to_world(to_double(kMesh.positions[v])));
  }
}

TEST(WritePly, ReadsBackWithFullPrecision) {
  std::stringstream stream;
  ASSERT_TRUE(write_ply(stream, kMesh, {}, to_world));
  expect_mapped_mesh(read_ply(stream));
}

TEST(WritePly, AttributesFollowEachPosition) {
  std::stringstream stream;
  ASSERT_TRUE(write_ply(stream, kMesh, kAttributes, to_world));
  std::string header;
  for (std::string line; std::getline(stream, line) && line != "end_header";) header += line + "\n";
  EXPECT_NE(header.find("property double z\nproperty uchar reliability\nproperty uint body\nproperty float value\n"),
            std::string::npos)
      << header;
  for (std::size_t v = 0; v < kMesh.positions.size(); ++v) {
    EXPECT_EQ(take<Vec3d>(stream), to_world(to_double(kMesh.positions[v])));
    EXPECT_EQ(take<std::uint8_t>(stream), kAttributes.reliability[v]);
    EXPECT_EQ(take<std::uint32_t>(stream), kAttributes.body[v]);
    EXPECT_EQ(take<float>(stream), kAttributes.value[v]);
  }
  EXPECT_EQ(take<std::uint8_t>(stream), 3);
  EXPECT_EQ(take<Triangle>(stream), kMesh.triangles[0]);
}

TEST(WritePly, AttributesThatAreAbsentAreNotDeclared) {
  std::stringstream stream;
  ASSERT_TRUE(write_ply(stream, kMesh, {.body = kAttributes.body}, {}));
  EXPECT_NE(stream.str().find("property double z\nproperty uint body\nelement face"), std::string::npos);
}

TEST(WriteObj, ReadsBackWithFullPrecision) {
  std::stringstream stream;
  ASSERT_TRUE(write_obj(stream, kMesh, to_world));
  expect_mapped_mesh(read_obj(stream));
}

TEST(WriteObj, WithoutMapHoldsIndexCoordinates) {
  std::stringstream stream;
  ASSERT_TRUE(write_obj(stream, {{{1, 2.5f, 3.015625f}, {0, 0, 0}, {100'000, 0, 0}}, {{0, 1, 2}}}, {}));
  EXPECT_EQ(stream.str(), "v 1 2.5 3.015625\nv 0 0 0\nv 1e+05 0 0\nf 1 2 3\n");
}

TEST(WriteStl, HoldsPositionsMinusTheOriginThatItsHeaderNames) {
  std::stringstream stream;
  ASSERT_TRUE(write_stl(stream, kMesh, to_world, {6'543'210.7, 432'100.1, -5}));
  std::string header(80, ' ');
  stream.read(header.data(), 80);
  EXPECT_EQ(header.substr(0, 29), "origin 6543210.7 432100.1 -5 ");
  ASSERT_EQ(take<std::uint32_t>(stream), kMesh.triangles.size());
  for (const Triangle& triangle : kMesh.triangles) {
    const Vec3f normal = take<Vec3f>(stream);
    std::array<Vec3d, 3> corners;
    for (int corner = 0; corner < 3; ++corner) {
      corners[corner] = to_double(take<Vec3f>(stream));
      const Vec3d p = to_double(kMesh.positions[triangle[corner]]);
      EXPECT_LT(norm(corners[corner] - Vec3d{p.x * 12.5 / 3, -p.y / 7, p.z * 4 + 5}), 1e-4);
    }
    const Vec3d face = cross(corners[1] - corners[0], corners[2] - corners[0]);
    EXPECT_NEAR(dot(face, to_double(normal)), norm(face), 1e-4 * norm(face));
    EXPECT_EQ(take<std::uint16_t>(stream), 0);
  }
  EXPECT_TRUE(stream);
  EXPECT_EQ(stream.peek(), std::char_traits<char>::eof());
}

TEST(WriteStl, TriangleWithoutAreaHasNoNormal) {
  std::stringstream stream;
  ASSERT_TRUE(write_stl(stream, {{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, {{0, 1, 2}}}, {}, {}));
  stream.seekg(84);
  EXPECT_EQ(take<Vec3f>(stream), Vec3f{});
}

TEST(WritePly, FilesLargerThanTheBufferComeBackWhole) {
  const IndexedMesh mesh = test::sheet(100, 0);
  std::stringstream stream;
  ASSERT_TRUE(write_ply(stream, mesh, {}, {}));
  EXPECT_EQ(read_ply(stream).triangles, mesh.triangles);
}

TEST(WritePly, AFullDiskIsAnError) {
  std::stringstream stream;
  stream.setstate(std::ios::badbit);
  for (const auto& written :
       {write_ply(stream, kMesh, {}, {}), write_obj(stream, kMesh, {}), write_stl(stream, kMesh, {}, {})}) {
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code, ErrorCode::unavailable);
  }
}

}  // namespace
}  // namespace geosis
