#include "server/app/problem.h"

#include <gtest/gtest.h>

namespace geosis::server {
namespace {

TEST(ProblemDocument, SaysCodeStatusAndDetail) {
  const Json problem = problem_document({ErrorCode::not_found, "volume abc: there is no such volume"});
  EXPECT_EQ(problem.at("code"), "not_found");
  EXPECT_EQ(problem.at("status"), 404);
  EXPECT_EQ(problem.at("detail"), "volume abc: there is no such volume");
  EXPECT_FALSE(problem.contains("pointer"));
}

TEST(ProblemDocument, NamesThePlaceInADocument) {
  const Json problem = problem_document({ErrorCode::invalid_argument, "request /range/0: \"x\"; expected a number"});
  EXPECT_EQ(problem.at("pointer"), "/range/0");
  EXPECT_EQ(problem.at("detail"), "\"x\"; expected a number");
}

}  // namespace
}  // namespace geosis::server
