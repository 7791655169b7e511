#include "server/net/tls_certificates.h"

#include <filesystem>
#include <fstream>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "server/net/pem.h"
#include "tests/server/store/temporary_folder.h"

namespace geosis::server {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

class TlsCertificatesTest : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) { std::ofstream(folder_.path() / name) << text; }
  /// As renewing programs do: written beside it, and moved.
  void replace(const std::string& name, const std::string& text) {
    write("new", text);
    fs::rename(folder_.path() / "new", folder_.path() / name);
  }
  std::string path(const char* name) const { return (folder_.path() / name).string(); }
  Result<std::unique_ptr<TlsCertificates>> read(bool asks_clients = false) {
    return TlsCertificates::read(
        {path("door.pem"), path("door.key"), asks_clients ? path("authorities.pem") : ""},
        [this](const std::optional<Error>& problem) { said_.push_back(problem ? problem->message : "renewed"); });
  }
  /// After the time in which the files are not looked at again.
  static auto later(TlsCertificates& certificates) {
    std::this_thread::sleep_for(1050ms);
    return certificates.latest();
  }

  geosis::test::TemporaryFolder folder_;
  const SignedKey first_ = *make_signed_key("first"), second_ = *make_signed_key("second");
  std::vector<std::string> said_;
};

TEST_F(TlsCertificatesTest, ARenewalIsTakenOnceItIsWhole) {
  write("door.pem", first_.certificate + second_.certificate);
  write("door.key", first_.key);
  const auto certificates = read();
  ASSERT_TRUE(certificates) << certificates.error().message;
  const auto before = (*certificates)->latest();
  EXPECT_EQ(before->certificate, first_.certificate + second_.certificate);

  replace("door.pem", second_.certificate);
  EXPECT_EQ((*certificates)->latest(), before);  // not looked at
  EXPECT_EQ(later(**certificates), before);
  ASSERT_EQ(said_.size(), 1u);
  EXPECT_NE(said_[0].find("door.key is not the key of"), std::string::npos) << said_[0];
  replace("door.key", second_.key);
  const auto after = later(**certificates);
  EXPECT_EQ(after->certificate, second_.certificate);
  EXPECT_EQ(after->key, second_.key);
  EXPECT_EQ(later(**certificates), after);
  EXPECT_EQ(said_.size(), 2u);
  EXPECT_EQ(said_.back(), "renewed");
}

TEST_F(TlsCertificatesTest, FilesThatAreGoneChangeNothing) {
  write("door.pem", first_.certificate);
  write("door.key", first_.key);
  const auto certificates = read();
  const auto before = (*certificates)->latest();
  fs::remove(path("door.pem"));
  EXPECT_EQ(later(**certificates), before);
  EXPECT_EQ(said_.size(), 1u);
}

TEST_F(TlsCertificatesTest, WhatIsNoneIsRefusedAtTheStart) {
  const auto refused = [&](const char* in, bool asks_clients = false) {
    const auto read = this->read(asks_clients);
    return !read && read.error().code == ErrorCode::invalid_argument &&
           read.error().message.find(in) != std::string::npos;
  };
  EXPECT_TRUE(refused("door.pem"));
  write("door.pem", first_.certificate);
  EXPECT_TRUE(refused("door.key"));
  write("door.key", second_.key);
  EXPECT_TRUE(refused("door.key"));
  write("door.key", first_.certificate);
  EXPECT_TRUE(refused("door.key"));
  write("door.key", first_.key);
  EXPECT_TRUE(read());
  EXPECT_TRUE(refused("authorities.pem", true));
  write("authorities.pem", "nobody\n");
  EXPECT_TRUE(refused("authorities.pem", true));
  write("authorities.pem", second_.certificate);
  EXPECT_TRUE(read(true));
  write("door.pem", first_.key);
  EXPECT_TRUE(refused("door.pem"));
}

}  // namespace
}  // namespace geosis::server
