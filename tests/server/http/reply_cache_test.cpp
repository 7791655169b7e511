#include "server/http/routing/reply_cache.h"

#include <gtest/gtest.h>

namespace geosis::server::http {
namespace {

ReplyCache::Kept answer_of(std::size_t bytes, char c = 'x') {
  return {{{"ETag", std::string(1, c)}}, std::make_shared<const std::string>(bytes, c)};
}

TEST(ReplyCache, GivesBackWhatItKeeps) {
  ReplyCache cache(1000);
  cache.keep("a", answer_of(10, 'a'));
  const auto found = cache.find("a");
  ASSERT_TRUE(found);
  EXPECT_EQ(*found->body, std::string(10, 'a'));
  EXPECT_EQ(found->headers.front().second, "a");
  EXPECT_FALSE(cache.find("b"));
}

TEST(ReplyCache, ForgetsTheLeastRecentlyUsedFirst) {
  ReplyCache cache(1000);
  for (const char* name : {"a", "b", "c", "d", "e", "f", "g", "h"}) cache.keep(name, answer_of(120));
  EXPECT_TRUE(cache.find("a"));
  cache.keep("i", answer_of(120));
  EXPECT_TRUE(cache.find("a"));
  EXPECT_FALSE(cache.find("b"));
  EXPECT_TRUE(cache.find("c"));
}

TEST(ReplyCache, CountsAReplacedAnswerOnce) {
  ReplyCache cache(1000);
  for (int i = 0; i < 100; ++i) cache.keep("a", answer_of(100));
  cache.keep("b", answer_of(100));
  EXPECT_TRUE(cache.find("a"));
  EXPECT_TRUE(cache.find("b"));
}

TEST(ReplyCache, DoesNotGiveItselfToOneBigAnswer) {
  ReplyCache cache(1000);
  cache.keep("a", answer_of(100));
  EXPECT_FALSE(cache.has_room_for(126));
  cache.keep("b", answer_of(126));
  EXPECT_FALSE(cache.find("b"));
  EXPECT_TRUE(cache.find("a"));
}

TEST(ReplyCache, AnswersInUseOutliveIt) {
  std::shared_ptr<const std::string> body;
  {
    ReplyCache cache(1000);
    cache.keep("a", answer_of(10, 'a'));
    body = cache.find("a")->body;
  }
  EXPECT_EQ(*body, std::string(10, 'a'));
}

}  // namespace
}  // namespace geosis::server::http
