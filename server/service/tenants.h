#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/app/extractions/extractions.h"
#include "server/app/housekeeping.h"
#include "server/app/services.h"
#include "server/app/volumes/volumes.h"

namespace geosis::server {

/// The use cases of each tenant, on one store and one queue. The queue must have stopped before this goes.
class Tenants {
 public:
  Tenants(BlobStore& store, JobQueue& queue, MemoryBudget& memory, int threads, const std::vector<std::string>& names);

  /// name   one of those given.
  Services services(const std::string& name) const;
  /// Tells of every extraction, whoever's it is. Set before the first request.
  void on_events(const ExtractionEvents& events);
  /// Removes what killed processes left, now and every hour.
  void keep_house();

 private:
  struct Tenant {
    std::unique_ptr<Volumes> volumes;
    std::unique_ptr<Extractions> extractions;
    std::unique_ptr<Housekeeping> housekeeping;
  };

  BlobStore& store_;
  JobQueue& queue_;
  MemoryBudget& memory_;
  std::map<std::string, Tenant> tenants_;
};

}  // namespace geosis::server
