#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <thread>

namespace geosis::server::http {

/// One thread for each running upload, at most so many. Used by the loop's thread only.
class UploadThreads {
 public:
  explicit UploadThreads(std::size_t most) : most_(most) {}
  ~UploadThreads() { join_all(); }

  bool has_room() const { return threads_.size() < most_; }
  /// False when there are enough already, or the system gives no thread. Work must not throw.
  bool start(std::uint64_t connection, std::function<void()> work);
  /// The connection's upload has answered: its thread is about to end.
  void finished(std::uint64_t connection);
  void join_all();

 private:
  std::size_t most_;
  std::map<std::uint64_t, std::thread> threads_;  ///< by connection
};

}  // namespace geosis::server::http
