#include "engine/volume/node_file.h"

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <xxhash.h>

#include "tests/engine/volume/scratch_folder.h"

namespace geosis {
namespace {

constexpr GridShape kShape = {3, 2, 4};
constexpr std::size_t kHeaderBytes = 168;

Vec3d place(int i, int j, int k) {
  return {5e5 + 25.0 * i, 6e6 + 12.5 * j, 1000 + 4.0 * k + i};
}

std::vector<Vec3d> small_nodes() {
  std::vector<Vec3d> nodes;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 2; ++j)
      for (int k = 0; k < 4; ++k) nodes.push_back(place(i, j, k));
  return nodes;
}

/// Written in pieces of so many nodes.
Result<NodeGrid> write(std::span<const Vec3d> nodes, const std::optional<std::filesystem::path>& path,
                       std::size_t piece = 100, bool times = false) {
  auto writer = NodeFileWriter::create(kShape, times, path);
  if (!writer) return std::move(writer).error();
  for (std::size_t n = 0; n < nodes.size(); n += piece) {
    if (auto put = writer->put(nodes.subspan(n, std::min(piece, nodes.size() - n))); !put) return put.error();
  }
  return std::move(*writer).finish(2);
}

/// Room for floats at its start.
struct Bytes {
  std::shared_ptr<std::vector<std::byte>> held;
  std::vector<std::byte>& operator*() const { return *held; }
};

Bytes small_file() {
  const ScratchFolder folder;
  EXPECT_TRUE(write(small_nodes(), folder / "nodes"));
  std::ifstream in(folder / "nodes", std::ios::binary);
  const std::vector<char> text{std::istreambuf_iterator<char>(in), {}};
  const Bytes file{std::make_shared<std::vector<std::byte>>(text.size())};
  std::memcpy((*file).data(), text.data(), text.size());
  return file;
}

Result<NodeGrid> read(const Bytes& file, GridShape shape = kShape) {
  return read_node_file(shape, *file, file.held);
}

void correct_checksums(std::vector<std::byte>& file) {
  const auto put = [&](std::size_t at, std::uint64_t value) { std::memcpy(file.data() + at, &value, sizeof value); };
  put(152, XXH3_64bits(file.data() + kHeaderBytes, file.size() - kHeaderBytes));
  put(160, 0);
  put(160, XXH3_64bits(file.data(), kHeaderBytes));
}

TEST(NodeFile, GivesTheGridBack) {
  const ScratchFolder folder;
  const auto written = write(small_nodes(), folder / "nodes", 5);
  ASSERT_TRUE(written) << written.error().message;
  const auto opened = open_node_file(kShape, folder / "nodes");
  ASSERT_TRUE(opened) << opened.error().message;
  for (const NodeGrid* grid : {&*written, &*opened}) {
    EXPECT_EQ(grid->summary.low, (Vec3d{5e5, 6e6, 1000}));
    EXPECT_EQ(grid->summary.high, (Vec3d{5e5 + 50, 6e6 + 12.5, 1014}));
    EXPECT_EQ(grid->summary.bytes, kHeaderBytes + 24 * 12);
    EXPECT_FALSE(grid->summary.report.mirrored);
    EXPECT_FALSE(grid->summary.times);
    EXPECT_EQ(grid->geometry.map({2, 1, 3}), place(2, 1, 3));
    EXPECT_EQ(grid->geometry.map({0.5, 0, 1}), (place(0, 0, 1) + place(1, 0, 1)) * 0.5);
  }
  EXPECT_EQ(opened->summary.digest, written->summary.digest);
}

TEST(NodeFile, IsNamedByWhereTheNodesAreAlone) {
  const auto name = [](std::span<const Vec3d> nodes, std::size_t piece, bool times) {
    const auto grid = write(nodes, std::nullopt, piece, times);
    return grid ? grid->summary.digest : grid.error().message;
  };
  auto nodes = small_nodes();
  const std::string digest = name(nodes, 100, false);
  EXPECT_EQ(digest.size(), 64u);
  EXPECT_EQ(name(nodes, 1, false), digest);
  EXPECT_NE(name(nodes, 100, true), digest);
  nodes[7].z += 1e-9;  // below what is kept
  EXPECT_EQ(name(nodes, 100, false), digest);
  nodes[7].z += 0.25;
  EXPECT_NE(name(nodes, 100, false), digest);
  for (Vec3d& node : nodes) node.x += 1;
  EXPECT_NE(name(nodes, 100, false), digest);
}

TEST(NodeFile, LeavesNothingBehindWhenItsNodesMakeNoGrid) {
  const ScratchFolder folder;
  auto nodes = small_nodes();
  EXPECT_FALSE(write(std::span(nodes).first(23), folder / "nodes"));
  nodes.push_back({});
  EXPECT_EQ(write(nodes, folder / "nodes").error().message,
            "node positions: more than the 24 nodes that the volume has");
  nodes.pop_back();
  nodes[9].y = -std::numeric_limits<double>::infinity();
  const auto odd = write(nodes, folder / "nodes", 4);
  ASSERT_FALSE(odd);
  EXPECT_EQ(odd.error().code, ErrorCode::malformed_input);
  EXPECT_EQ(odd.error().message, "node positions: node [1,0,1] is (500025, -inf, 1005): not finite");
  nodes[9].y = 1e300;
  EXPECT_NE(write(nodes, folder / "nodes").error().message.find("too far from the first node"), std::string::npos);
  nodes = small_nodes();
  std::swap(nodes[8], nodes[16]);
  const auto folded = write(nodes, folder / "nodes");
  ASSERT_FALSE(folded);
  EXPECT_NE(folded.error().message.find("folded"), std::string::npos) << folded.error().message;
  EXPECT_FALSE(NodeFileWriter::create({2, 1, 2}, false, folder / "nodes"));
  EXPECT_FALSE(NodeFileWriter::create({2, 1 << 20, 2}, false, folder / "nodes"));
  EXPECT_TRUE(folder.is_empty());
}

TEST(NodeFile, HasTheBytesThatItsPageDescribes) {
  const Bytes file = small_file();
  ASSERT_EQ((*file).size(), kHeaderBytes + 24 * 12);
  EXPECT_EQ(std::memcmp((*file).data(), "GEONODES", 8), 0);
  const auto at = [&]<class Number>(std::size_t place, Number) {
    Number value;
    std::memcpy(&value, (*file).data() + place, sizeof value);
    return value;
  };
  EXPECT_EQ(at(8, 0), 1);
  EXPECT_EQ(at(12, 0), 3);
  EXPECT_EQ(at(16, 0), 2);
  EXPECT_EQ(at(20, 0), 4);
  EXPECT_EQ(at(24, 0), 0);
  EXPECT_EQ(at(32, 0.0), 5e5);
  EXPECT_EQ(at(40, 0.0), 6e6);
  EXPECT_EQ(at(56, 0.0), 5e5);
  EXPECT_EQ(at(80, 0.0), 5e5 + 50);
  EXPECT_EQ(at(104, std::int64_t{}), 0);
  EXPECT_EQ(at(144, std::uint64_t{}), kHeaderBytes + 24 * 12);
  EXPECT_EQ(at(kHeaderBytes + 12 + 8, 0.0f), 4.0f);
}

TEST(NodeFile, IsRefusedWhateverByteIsDamaged) {
  const Bytes sound = small_file();
  ASSERT_TRUE(read(sound));
  for (std::size_t at = 0; at < (*sound).size(); ++at) {
    (*sound)[at] ^= std::byte{0x10};
    EXPECT_FALSE(read(sound)) << at;
    (*sound)[at] ^= std::byte{0x10};
  }
  EXPECT_FALSE(read(sound, {2, 3, 4}));
  for (std::size_t size = 0; size < (*sound).size(); size += 7) {
    EXPECT_FALSE(read_node_file(kShape, std::span(*sound).first(size), sound.held)) << size;
  }
}

TEST(NodeFile, IsRefusedWhenItsChecksumsAreRightAndItsNumbersAreNot) {
  const Bytes file = small_file();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy((*file).data() + kHeaderBytes + 40, &nan, sizeof nan);
  correct_checksums(*file);
  const auto refused = read(file);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "node file: a position is not finite");
  const Bytes odd = small_file();
  const std::int64_t folded = 7;
  std::memcpy((*odd).data() + 104, &folded, sizeof folded);
  correct_checksums(*odd);
  EXPECT_FALSE(read(odd));
  const Bytes nowhere = small_file();
  std::memset((*nowhere).data() + 32, 0xff, 8);
  correct_checksums(*nowhere);
  EXPECT_FALSE(read(nowhere));
}

}  // namespace
}  // namespace geosis
