#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include <grpcpp/security/credentials.h>

namespace geosis::server::rpc {

/// Asks the door for its health as a client would, over a connection of its own, from time to time: a gRPC server that
/// has stopped accepting or answering does not notice by itself.
class SelfProbe {
 public:
  /// may_be_full   whether a failure may come from too many clients, which is no reason to start again.
  SelfProbe(std::string target, std::shared_ptr<grpc::ChannelCredentials> credentials,
            std::chrono::milliseconds interval, std::function<bool()> may_be_full);
  ~SelfProbe();

  /// Why the door is dead; nothing while it answers.
  std::optional<std::string> problem() const;

 private:
  void run();
  bool ask() const;

  const std::string target_;
  const std::shared_ptr<grpc::ChannelCredentials> credentials_;
  const std::chrono::milliseconds interval_;
  const std::function<bool()> may_be_full_;
  std::atomic<int> failures_{0};  ///< in a row
  std::mutex mutex_;
  std::condition_variable stopped_;
  bool is_stopping_ = false;
  std::thread thread_;
};

}  // namespace geosis::server::rpc
