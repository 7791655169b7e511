#include "server/grpc/connections/self_probe.h"

#include <thread>

#include <gtest/gtest.h>

#include "server/net/listener.h"

namespace geosis::server::rpc {
namespace {

using namespace std::chrono_literals;

bool has_problem_soon(const SelfProbe& probe, std::chrono::milliseconds time) {
  const auto end = std::chrono::steady_clock::now() + time;
  while (std::chrono::steady_clock::now() < end) {
    if (probe.problem()) return true;
    std::this_thread::sleep_for(5ms);
  }
  return false;
}

/// An address where nobody listens.
std::string dead_address() {
  Listener listener = *Listener::open("127.0.0.1:0");
  return "127.0.0.1:" + std::to_string(listener.port());
}

TEST(SelfProbe, TellsOfADoorThatDoesNotAnswer) {
  const SelfProbe probe(dead_address(), grpc::InsecureChannelCredentials(), 5ms, [] { return false; });
  EXPECT_TRUE(has_problem_soon(probe, 20s));
}

TEST(SelfProbe, BlamesNoDoorThatIsFull) {
  const SelfProbe probe(dead_address(), grpc::InsecureChannelCredentials(), 5ms, [] { return true; });
  EXPECT_FALSE(has_problem_soon(probe, 300ms));
}

}  // namespace
}  // namespace geosis::server::rpc
