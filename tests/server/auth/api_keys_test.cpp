#include "server/auth/api_keys.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace geosis::server {
namespace {

const Scopes kBoth{.read = true, .write = true};

TEST(ApiKeys, KnowAMadeKeyAndNoOther) {
  const auto ci = make_key({"ci", "default", kBoth});
  const auto reader = make_key({"reader", "acme", {.read = true}});
  ASSERT_TRUE(ci && reader);
  EXPECT_NE(ci->key, make_key({"ci", "default", kBoth})->key);
  EXPECT_EQ(ci->line.find(ci->key), std::string::npos);
  const auto keys = ApiKeys::parse("# comment\n\n" + ci->line + "\n  " + reader->line + "\r\n");
  ASSERT_TRUE(keys) << keys.error().message;
  const Caller* const found = keys->find(reader->key);
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->name + " " + found->tenant, "reader acme");
  EXPECT_TRUE(found->scopes.read);
  EXPECT_FALSE(found->scopes.write);
  EXPECT_TRUE(keys->find(ci->key)->scopes.write);
  std::string wrong = ci->key;
  wrong.back() = wrong.back() == '0' ? '1' : '0';
  for (const std::string& key : {wrong, std::string(), ci->key + " ", ci->key.substr(1), ci->line}) {
    EXPECT_EQ(keys->find(key), nullptr) << key;
  }
  EXPECT_EQ(keys->tenants(), (std::vector<std::string>{"acme", "default"}));
}

TEST(ApiKeys, HashesAreThoseOfSha256sum) {
  // printf %s abc | sha256sum
  const auto keys =
      ApiKeys::parse("a sha256:ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad t volumes:read");
  ASSERT_TRUE(keys);
  EXPECT_NE(keys->find("abc"), nullptr);
}

TEST(ApiKeys, RefuseLinesThatMakeNoSenseWithoutRepeatingThem) {
  const std::string hash = "sha256:" + std::string(64, 'a');
  const std::vector<std::string> bad = {
      "",
      "# nothing",
      "secret",
      "a secret t volumes:read",
      "a " + hash + "0 t volumes:read",
      "a sha256:" + std::string(64, 'A') + " t volumes:read",
      "a " + hash + " T volumes:read",
      "../a " + hash + " t volumes:read",
      "a " + hash + " ../t volumes:read",
      "a " + hash + " t",
      "a " + hash + " t volumes:secret",
      "a " + hash + " t volumes:read more",
      "a " + hash + " t volumes:read\na sha256:" + std::string(64, 'b') + " t volumes:read",
      "a " + hash + " t volumes:read\nb " + hash + " t volumes:read"};
  for (const std::string& text : bad) {
    const auto keys = ApiKeys::parse(text);
    ASSERT_FALSE(keys) << text;
    EXPECT_EQ(keys.error().code, ErrorCode::malformed_input);
    EXPECT_EQ(keys.error().message.find("secret"), std::string::npos);
  }
  EXPECT_NE(ApiKeys::parse("\n\na b").error().message.find("line 3"), std::string::npos);
}

TEST(MakeKey, RefusesWhatTheFileCouldNotHold) {
  EXPECT_FALSE(make_key({"a b", "default", kBoth}));
  EXPECT_FALSE(make_key({"a", "De", kBoth}));
  EXPECT_FALSE(make_key({"a", "", kBoth}));
  EXPECT_FALSE(make_key({"a", "t", {}}));
}

}  // namespace
}  // namespace geosis::server
