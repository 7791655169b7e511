#include "server/grpc/connections/flood_reports.h"

#include <gtest/gtest.h>

namespace geosis::server::rpc {
namespace {

using namespace std::chrono_literals;

TEST(FloodReports, SumsUpASecondAndTellsWhenItIsOver) {
  std::vector<std::string> said;
  int over = 0;
  FloodReports reports(
      [&](std::size_t count, const std::string& last) { said.push_back(std::to_string(count) + last); },
      [&] { ++over; });
  const auto start = FloodReports::Clock::now();
  reports.tick(start);
  EXPECT_TRUE(said.empty() && over == 0);
  reports.note({"a", "b"}, start);
  reports.tick(start);
  EXPECT_EQ(said, std::vector<std::string>{"2b"});
  reports.note({"c"}, start + 300ms);
  reports.note({}, start + 400ms);
  reports.note({"d"}, start + 600ms);
  reports.tick(start + 999ms);
  EXPECT_EQ(said.size(), 1u);
  reports.tick(start + 1s);
  EXPECT_EQ(said.back(), "2d");
  EXPECT_EQ(over, 0);
  reports.tick(start + 1600ms);
  reports.tick(start + 5s);
  EXPECT_EQ(over, 1);
  EXPECT_EQ(said.size(), 2u);
}

}  // namespace
}  // namespace geosis::server::rpc
