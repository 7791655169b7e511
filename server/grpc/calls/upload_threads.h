#pragma once

#include <functional>
#include <list>
#include <mutex>
#include <string>
#include <thread>

#include "server/jobs/slots.h"

namespace geosis::server::rpc {

/// One thread for each running upload, as many as there are slots; one peer never holds the last quarter of them. Any
/// thread but those may call any member.
class UploadThreads {
 public:
  explicit UploadThreads(Slots& slots) : slots_(slots) {}
  ~UploadThreads() { join_all(); }

  /// False when there are enough already, or the system gives no thread. Work must not throw.
  bool start(const std::string& peer, std::function<void()> work);
  void join_all();
  /// Uploads that may run at one time.
  std::size_t most() const { return slots_.most(); }

 private:
  struct Running {
    std::string peer;
    std::thread thread;
    bool has_ended = false;
  };
  void join_ended();

  Slots& slots_;
  std::mutex mutex_;
  std::list<Running> threads_;
};

}  // namespace geosis::server::rpc
