#include "server/grpc/certificate.h"

#include <gtest/gtest.h>

namespace geosis::server::rpc {
namespace {

TEST(SignedKey, IsAnotherOneEachTime) {
  const SignedKey first = *make_signed_key("one"), second = *make_signed_key("one");
  EXPECT_NE(first.key, second.key);
  EXPECT_EQ(count_certificates(first.certificate), 1u);
  EXPECT_EQ(count_certificates(first.key), 0u);
}

TEST(CountCertificates, CountsNoneWhereOneIsDamaged) {
  const std::string one = make_signed_key("one")->certificate, cut = one.substr(0, one.size() / 2);
  EXPECT_EQ(count_certificates("What follows is ours:\n" + one + "and\n" + one), 2u);
  EXPECT_EQ(count_certificates(one + cut), 0u);
  EXPECT_EQ(count_certificates(cut), 0u);
  EXPECT_EQ(count_certificates(""), 0u);
  EXPECT_EQ(count_certificates("nobody"), 0u);
}

}  // namespace
}  // namespace geosis::server::rpc
