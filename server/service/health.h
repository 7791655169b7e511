#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/jobs/job_queue.h"
#include "server/store/blob_store.h"

namespace geosis::server {

/// Whether this server should be sent requests, and whether it should be started again. Any thread may call any member.
class Health {
 public:
  Health(BlobStore& store, JobQueue& queue) : store_(store), queue_(queue) {}

  /// Why no requests should come here now; empty = they should. Writes an empty file into the store's staging.
  std::vector<std::string> not_ready();
  /// Why this process will not get better by itself: a job that computes but has not asked for minutes whether to go
  /// on, or what ask_also() tells of.
  std::optional<std::string> not_alive();
  /// Something else that may be why. Before the first question.
  void ask_also(std::function<std::optional<std::string>()> not_alive) { also_ = std::move(not_alive); }
  void set_draining() { is_draining_ = true; }

 private:
  BlobStore& store_;
  JobQueue& queue_;
  std::function<std::optional<std::string>()> also_;
  std::atomic<bool> is_draining_{false};
};

}  // namespace geosis::server
