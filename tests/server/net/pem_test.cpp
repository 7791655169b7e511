#include "server/net/pem.h"

#include <gtest/gtest.h>

namespace geosis::server {
namespace {

// openssl genpkey -algorithm ED25519 -aes256 -pass pass:geosis
constexpr const char* kLocked =
    "-----BEGIN ENCRYPTED PRIVATE KEY-----\n"
    "MIGbMFcGCSqGSIb3DQEFDTBKMCkGCSqGSIb3DQEFDDAcBAga/arUhPimAAICCAAw\n"
    "DAYIKoZIhvcNAgkFADAdBglghkgBZQMEASoEEEKCxPTAFX/c8TBbUibrVZAEQOJ5\n"
    "4tl5xabcecSOefl5dn7Agw2O6SCVTb725LyGLEbZMNkqp0VuAiUGx39Yqg0WRwSA\n"
    "hD2d+IcQg/taqXC5bCg=\n"
    "-----END ENCRYPTED PRIVATE KEY-----\n";

TEST(SignedKey, IsAnotherOneEachTime) {
  const SignedKey first = *make_signed_key("one"), second = *make_signed_key("one");
  EXPECT_NE(first.key, second.key);
  EXPECT_EQ(read_certificates(first.certificate).size(), 1u);
  EXPECT_EQ(read_certificates(first.key).size(), 0u);
}

TEST(ReadCertificates, GivesNoneWhereOneIsDamaged) {
  const std::string one = make_signed_key("one")->certificate, cut = one.substr(0, one.size() / 2);
  EXPECT_EQ(read_certificates("What follows is ours:\n" + one + "and\n" + one).size(), 2u);
  EXPECT_EQ(read_certificates(one + cut).size(), 0u);
  EXPECT_EQ(read_certificates(cut).size(), 0u);
  EXPECT_EQ(read_certificates("").size(), 0u);
  EXPECT_EQ(read_certificates("nobody").size(), 0u);
}

TEST(ReadKey, TakesOneThatNeedsNoPassword) {
  const SignedKey own = *make_signed_key("one");
  EXPECT_TRUE(read_key("before\n" + own.key));
  EXPECT_FALSE(read_key(own.certificate));
  EXPECT_FALSE(read_key(own.key.substr(0, own.key.size() / 2)));
  EXPECT_FALSE(read_key(kLocked));
}

}  // namespace
}  // namespace geosis::server
