#include "server/auth/admission.h"

#include <string>

#include <gtest/gtest.h>

namespace geosis::server {
namespace {

TEST(AdmitCaller, WithoutKeysAnybodyMayDoAnything) {
  for (const bool writes : {false, true}) {
    const auto caller = admit_caller(std::nullopt, "", writes);
    ASSERT_TRUE(caller);
    EXPECT_EQ(caller->tenant, "default");
  }
}

TEST(AdmitCaller, AKeyOpensWhatItsScopesSay) {
  const auto reader = make_key({"reader", "acme", {.read = true}});
  const auto writer = make_key({"writer", "acme", {.write = true}});
  ASSERT_TRUE(reader && writer);
  const std::optional<ApiKeys> keys = *ApiKeys::parse(reader->line + "\n" + writer->line);
  const auto code_of = [&](const std::string& authorization, bool writes) {
    const auto caller = admit_caller(keys, authorization, writes);
    return caller ? caller->tenant : name_of(caller.error().code);
  };
  EXPECT_EQ(code_of("Bearer " + reader->key, false), "acme");
  EXPECT_EQ(code_of("bEARER  " + reader->key + " ", false), "acme");
  EXPECT_EQ(code_of("Bearer " + reader->key, true), "permission_denied");
  EXPECT_EQ(code_of("Bearer " + writer->key, true), "acme");
  EXPECT_EQ(code_of("Bearer " + writer->key, false), "permission_denied");
  for (const std::string& wrong : {std::string(), std::string("Bearer"), std::string("Bearer "), reader->key,
                                   "Basic " + reader->key, "Bearer" + reader->key, "Bearer " + reader->key + "0"}) {
    EXPECT_EQ(code_of(wrong, false), "unauthenticated") << wrong;
  }
}

}  // namespace
}  // namespace geosis::server
