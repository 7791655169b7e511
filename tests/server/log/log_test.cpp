#include "server/log/log.h"

#include <cmath>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace geosis::server {
namespace {

const std::vector<LogField> kFields = {
    {"path", std::string("/a b\n\"c\"")}, {"status", std::int64_t{200}}, {"seconds", 0.25}, {"odd", std::nan("")}};

TEST(LogLine, IsOneLineOfTextWhateverItHolds) {
  EXPECT_EQ(log_line(LogFormat::text, "T", LogLevel::info, "request\nbroken", kFields),
            "T info request\\u000abroken path=\"/a b\\u000a\\\"c\\\"\" status=200 seconds=0.25 odd=null");
  EXPECT_EQ(log_line(LogFormat::text, "T", LogLevel::error, "m", {{"name", std::string()}, {"x", std::string("a/b")}}),
            "T error m name=\"\" x=a/b");
}

TEST(LogLine, IsAnObjectOfJson) {
  EXPECT_EQ(log_line(LogFormat::json, "T", LogLevel::warning, "request", kFields),
            "{\"time\":\"T\",\"level\":\"warning\",\"message\":\"request\",\"path\":\"/a b\\u000a\\\"c\\\"\","
            "\"status\":200,\"seconds\":0.25,\"odd\":null}");
  EXPECT_EQ(log_line(LogFormat::json, "T", LogLevel::debug, "\xff\x7f", {}),
            "{\"time\":\"T\",\"level\":\"debug\",\"message\":\"\\u00ff\\u007f\"}");
}

TEST(Log, WritesWhatIsImportantEnoughBeforeItEnds) {
  testing::internal::CaptureStderr();
  {
    Log log(LogFormat::text, LogLevel::info);
    log.write(LogLevel::debug, "unseen");
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([&] {
        for (int i = 0; i < 50; ++i) log.write(LogLevel::info, "seen", {{"n", std::int64_t{i}}});
      });
    }
  }
  const std::string text = testing::internal::GetCapturedStderr();
  EXPECT_EQ(text.find("unseen"), std::string::npos);
  int lines = 0;
  for (std::size_t at = 0; (at = text.find("Z info seen n=", at)) != std::string::npos; ++at) ++lines;
  EXPECT_EQ(lines, 200);
}

}  // namespace
}  // namespace geosis::server
