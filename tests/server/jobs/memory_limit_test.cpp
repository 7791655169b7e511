#include "server/jobs/memory_limit.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

namespace geosis::server {
namespace {

/// A made-up /proc and /sys/fs/cgroup of a machine with 8 GiB.
class MemoryLimit : public testing::Test {
 protected:
  MemoryLimit() { write("proc/meminfo", "MemTotal:        8388608 kB\nMemFree: 1 kB\n"); }
  ~MemoryLimit() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }
  std::uint64_t limit() { return memory_limit(folder_ / "proc", folder_ / "groups"); }

 private:
  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("geosis-limit-" + std::to_string(getpid()));
};

constexpr std::uint64_t kMachine = std::uint64_t{8} << 30;

TEST_F(MemoryLimit, IsTheMachinesWithoutGroups) {
  EXPECT_EQ(limit(), kMachine);
  write("proc/self/cgroup", "0::/\nnonsense\n");
  write("groups/memory.max", "max\n");
  EXPECT_EQ(limit(), kMachine);
}

TEST_F(MemoryLimit, IsTheTightestOfVersion2) {
  write("proc/self/cgroup", "0::/pods/one\n");
  write("groups/pods/memory.max", "3000000000\n");
  write("groups/pods/one/memory.max", "max\n");
  EXPECT_EQ(limit(), 3000000000U);
  write("groups/pods/one/memory.max", "1000000000\n");
  EXPECT_EQ(limit(), 1000000000U);
}

TEST_F(MemoryLimit, IsTheOneOfAContainersRoot) {
  write("proc/self/cgroup", "0::/not/visible/here\n");
  write("groups/memory.max", "268435456\n");
  EXPECT_EQ(limit(), 268435456U);
}

TEST_F(MemoryLimit, IsTheTightestOfVersion1) {
  write("proc/self/cgroup", "5:cpu,cpuacct:/other\n4:memory:/docker/a\n0::/\n");
  write("groups/memory/memory.limit_in_bytes", "9223372036854771712\n");
  write("groups/memory/docker/a/memory.limit_in_bytes", "536870912\n");
  EXPECT_EQ(limit(), 536870912U);
}

TEST_F(MemoryLimit, NeverExceedsTheMachine) {
  write("groups/memory/memory.limit_in_bytes", "9223372036854771712\n");
  EXPECT_EQ(limit(), kMachine);
}

}  // namespace
}  // namespace geosis::server
