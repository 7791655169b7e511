#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <thread>

#include "server/jobs/slots.h"

namespace geosis::server::http {

/// One thread for each running upload, as many as there are slots; one peer never holds the last quarter of them. Used
/// by the loop's thread only.
class UploadThreads {
 public:
  explicit UploadThreads(Slots& slots) : slots_(slots) {}
  ~UploadThreads() { join_all(); }

  bool has_room(const std::string& peer) const;
  /// False when there are enough already, or the system gives no thread. Work must not throw.
  bool start(std::uint64_t connection, const std::string& peer, std::function<void()> work);
  /// The connection's upload has answered: its thread is about to end.
  void finished(std::uint64_t connection);
  void join_all();

 private:
  struct Upload {
    std::string peer;
    std::thread thread;
    Slots::Slot slot;
  };

  Slots& slots_;
  std::map<std::uint64_t, Upload> uploads_;  ///< by connection
};

}  // namespace geosis::server::http
