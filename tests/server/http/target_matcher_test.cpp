#include "server/http/wire/target_matcher.h"

#include <gtest/gtest.h>

namespace geosis::server::http {
namespace {

using Captures = std::vector<std::string>;

TargetMatcher matcher_of(std::initializer_list<const char*> patterns) {
  TargetMatcher matcher;
  for (const char* pattern : patterns) matcher.add(pattern);
  return matcher;
}

TEST(TargetMatcher, CapturesSegmentsDigitsAndWords) {
  const auto matcher = matcher_of({"/v/([^/]+)/lods/([0-9]+)\\.(drc|glb)"});
  const auto match = matcher.match("/v/a.b/lods/12.glb");
  ASSERT_TRUE(match && match->pattern);
  EXPECT_EQ(match->captures, (Captures{"a.b", "12", "glb"}));
  for (const char* other :
       {"/v/a/lods/12.ply", "/v/a/lods/12xglb", "/v/a/lods/.glb", "/v//lods/1.glb", "/v/a/b/lods/1.glb",
        "/v/a/lods/1.glb/", "/v/a/lods/1.glbx", "/v/a/lods/1", "x/v/a/lods/1.glb"}) {
    const auto missed = matcher.match(other);
    ASSERT_TRUE(missed) << other;
    EXPECT_FALSE(missed->pattern) << other;
    EXPECT_TRUE(missed->captures.empty()) << other;
  }
}

TEST(TargetMatcher, TakesTheFirstPatternThatMatches) {
  const auto matcher = matcher_of({"/a/b", "/a/([^/]+)", "/a/.*"});
  EXPECT_EQ(matcher.match("/a/b")->pattern, 0U);
  EXPECT_EQ(matcher.match("/a/c")->pattern, 1U);
  EXPECT_EQ(matcher.match("/a/c/d")->pattern, 2U);
  EXPECT_EQ(matcher.match("/a/")->pattern, 2U);
  EXPECT_FALSE(matcher.match("/a")->pattern);
}

TEST(TargetMatcher, DecodesPathAndQuery) {
  const auto match = matcher_of({"/([^/]+)"}).match("/a%20b+c?x=1%262&y=a+b&x=3&flag&=&&z=%c3%a4=");
  ASSERT_TRUE(match && match->pattern);
  EXPECT_EQ(match->captures, Captures{"a b+c"});
  const std::multimap<std::string, std::string> expected{{"", ""},   {"flag", ""}, {"x", "1&2"},
                                                         {"x", "3"}, {"y", "a b"}, {"z", "\xc3\xa4="}};
  EXPECT_EQ(match->query, expected);
}

TEST(TargetMatcher, ReadsAnEncodedSlashAsASlash) {
  const auto matcher = matcher_of({"/a/([^/]+)"});
  EXPECT_FALSE(matcher.match("/a/b%2fc")->pattern);
  EXPECT_TRUE(matcher.match("/a%2Fb")->pattern);
}

TEST(TargetMatcher, RefusesWhatIsNotEncodedWell) {
  const auto matcher = matcher_of({"/.*"});
  for (const char* target : {"/%", "/%4", "/%4g", "/%g4", "/?a=%", "/?%zz=1", "/a%00b", "/a%0d%0ab", "/%7f"})
    EXPECT_FALSE(matcher.match(target)) << target;
}

TEST(TargetMatcher, IsDoneSoonWithLongPaths) {
  const auto matcher = matcher_of({"/([^/]+)/([^/]+)/x", "/([^/]+)/([0-9]+)/([^/]+)/y", "/.*"});
  const std::string path = "/" + std::string(3900, 'a') + "/" + std::string(3900, '1') + "/z";
  EXPECT_EQ(matcher.match(path)->pattern, 2U);
}

}  // namespace
}  // namespace geosis::server::http
