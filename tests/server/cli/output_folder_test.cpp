#include "server/cli/output_folder.h"

#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

namespace geosis::server {
namespace {

namespace fs = std::filesystem;

class OutputFolderTest : public testing::Test {
 protected:
  OutputFolderTest() {
    std::string name = testing::TempDir() + "/geosis-XXXXXX";
    root_ = mkdtemp(name.data());
  }
  ~OutputFolderTest() override { fs::remove_all(root_); }

  std::set<std::string> names_in(const fs::path& folder) const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename());
    return names;
  }

  fs::path root_;
};

Result<void> hello(std::ostream& stream) {
  stream << "hello";
  return {};
}

bool never(const std::string&) {
  return false;
}

TEST_F(OutputFolderTest, CommitMovesTheFilesToTheirPlace) {
  {
    auto folder = OutputFolder::open(root_ / "a" / "b").value();
    ASSERT_TRUE(folder.write("lod0.drc", hello));
    ASSERT_TRUE(folder.write("manifest.json", hello));
    ASSERT_TRUE(folder.commit(never));
  }
  EXPECT_EQ(names_in(root_ / "a" / "b"), (std::set<std::string>{"lod0.drc", "manifest.json"}));
  std::ifstream file(root_ / "a" / "b" / "lod0.drc");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "hello");
}

TEST_F(OutputFolderTest, NothingStaysWithoutCommit) {
  {
    auto folder = OutputFolder::open(root_ / "new").value();
    ASSERT_TRUE(folder.write("lod0.drc", hello));
  }
  EXPECT_TRUE(fs::is_empty(root_));
}

TEST_F(OutputFolderTest, AFolderThatWasThereStaysWithItsFiles) {
  std::ofstream(root_ / "lod0.drc") << "old";
  {
    auto folder = OutputFolder::open(root_).value();
    ASSERT_TRUE(folder.write("lod0.drc", hello));
  }
  EXPECT_EQ(names_in(root_), std::set<std::string>{"lod0.drc"});
  EXPECT_EQ(fs::file_size(root_ / "lod0.drc"), 3u);
}

TEST_F(OutputFolderTest, CommitRemovesStaleFilesAndNoOthers) {
  for (const char* name : {"lod7.drc", "notes.txt"}) std::ofstream(root_ / name) << "old";
  auto folder = OutputFolder::open(root_).value();
  ASSERT_TRUE(folder.write("lod0.drc", hello));
  ASSERT_TRUE(folder.commit([](const std::string& name) { return name == "lod7.drc"; }));
  EXPECT_TRUE(fs::exists(root_ / "lod0.drc"));
  EXPECT_FALSE(fs::exists(root_ / "lod7.drc"));
  EXPECT_TRUE(fs::exists(root_ / "notes.txt"));
}

TEST_F(OutputFolderTest, WriteReportsWhatFillReports) {
  auto folder = OutputFolder::open(root_).value();
  const auto written = folder.write("lod0.ply", [](std::ostream&) -> Result<void> {
    return Error{ErrorCode::invalid_argument, "no triangles"};
  });
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().message, "no triangles");
}

TEST_F(OutputFolderTest, WriteReportsAFullDisk) {
  auto folder = OutputFolder::open(root_).value();
  const auto written = folder.write("lod0.drc", [](std::ostream& stream) -> Result<void> {
    stream.setstate(std::ios::badbit);
    return {};
  });
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::unavailable);
}

TEST_F(OutputFolderTest, OpenRefusesAPathThroughAFile) {
  std::ofstream(root_ / "file") << "x";
  const auto folder = OutputFolder::open(root_ / "file" / "out");
  ASSERT_FALSE(folder);
  EXPECT_EQ(folder.error().code, ErrorCode::unavailable);
}

}  // namespace
}  // namespace geosis::server
