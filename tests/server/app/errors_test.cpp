#include "server/app/errors.h"

#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace geosis::server {
namespace {

constexpr int kCodes = static_cast<int>(ErrorCode::internal) + 1;

TEST(NumbersOf, EachCodeHasTheNumbersOfTheContract) {
  const std::map<std::string, std::pair<int, int>> expected = {
      {"invalid_argument", {400, 3}}, {"malformed_input", {422, 3}},   {"unsupported", {422, 12}},
      {"not_found", {404, 5}},        {"already_exists", {409, 6}},    {"limit_exceeded", {413, 8}},
      {"no_space", {507, 8}},         {"cancelled", {499, 1}},         {"deadline_exceeded", {504, 4}},
      {"unauthenticated", {401, 16}}, {"permission_denied", {403, 7}}, {"quota_exceeded", {429, 8}},
      {"unavailable", {503, 14}},     {"internal", {500, 13}}};
  ASSERT_EQ(expected.size(), static_cast<std::size_t>(kCodes));
  for (int i = 0; i < kCodes; ++i) {
    const auto code = static_cast<ErrorCode>(i);
    const auto& numbers = numbers_of(code);
    EXPECT_EQ(numbers.code, code);
    ASSERT_TRUE(expected.contains(name_of(code))) << name_of(code);
    EXPECT_EQ(std::pair(numbers.http_status, numbers.grpc_status), expected.at(name_of(code))) << name_of(code);
  }
}

/// Of google.rpc.Code, by number.
const char* grpc_name(int number) {
  static constexpr const char* kNames[] = {
      "OK",        "CANCELLED",      "UNKNOWN",           "INVALID_ARGUMENT",   "DEADLINE_EXCEEDED",
      "NOT_FOUND", "ALREADY_EXISTS", "PERMISSION_DENIED", "RESOURCE_EXHAUSTED", "FAILED_PRECONDITION",
      "ABORTED",   "OUT_OF_RANGE",   "UNIMPLEMENTED",     "INTERNAL",           "UNAVAILABLE",
      "DATA_LOSS", "UNAUTHENTICATED"};
  return kNames[number];
}

TEST(NumbersOf, TheContractsTableHasTheSameRows) {
  std::ifstream file(GEOSIS_CONTRACT_README);
  ASSERT_TRUE(file.is_open());
  const std::regex row(R"(\| (\w+) \| (\d{3})[^|]* \| ([A-Z_]+) \|)");
  std::map<std::string, std::pair<int, std::string>> told, known;
  std::smatch match;
  for (std::string line; std::getline(file, line);) {
    if (std::regex_match(line, match, row)) told[match[1]] = {std::stoi(match[2]), match[3]};
  }
  for (int i = 0; i < kCodes; ++i) {
    const auto& numbers = numbers_of(static_cast<ErrorCode>(i));
    known[name_of(numbers.code)] = {numbers.http_status, grpc_name(numbers.grpc_status)};
  }
  EXPECT_EQ(told, known);
}

TEST(NumbersOf, TitlesTellTheCodesApart) {
  std::set<std::string> titles;
  for (int i = 0; i < kCodes; ++i) titles.insert(numbers_of(static_cast<ErrorCode>(i)).title);
  EXPECT_EQ(titles.size(), static_cast<std::size_t>(kCodes));
}

}  // namespace
}  // namespace geosis::server
