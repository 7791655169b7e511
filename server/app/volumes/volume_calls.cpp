#include "server/app/volumes/volume_calls.h"

#include <utility>

#include "server/app/volumes/imports.h"

namespace geosis::server {
namespace {

Imports imports_of(const Services& services) {
  return {services.store, services.volumes, services.queue};
}

}  // namespace

Result<Json> show_volume(const Services& services, const std::string& id) {
  auto document = services.volumes.document(id);
  if (document || document.error().code != ErrorCode::not_found) return document;
  return imports_of(services).document(id);
}

Result<void> remove_volume(const Services& services, const std::string& id) {
  const auto known = services.volumes.document(id);
  if (!known && known.error().code == ErrorCode::not_found) return imports_of(services).remove(id);
  // A damaged one cannot be shown but can be removed.
  if (!known && known.error().code != ErrorCode::internal) return known.error();
  if (auto purged = services.extractions.purge_results_of(id); !purged) return purged;
  if (auto removed = services.volumes.remove(id); !removed) return removed;
  return services.volumes.grids().remove_all(id);
}

Result<std::shared_ptr<Job>> begin_histogram(const Services& services, const std::string& id, int bins,
                                             std::shared_ptr<Histogram> counted) {
  const auto count = [services, id, bins, counted = std::move(counted)](Job& job) -> Result<void> {
    auto result = services.volumes.histogram(id, bins, job);
    if (!result) return std::move(result).error();
    *counted = *std::move(result);
    return {};
  };
  return services.queue.submit(JobDemand{.tenant = services.volumes.tenant(), .what = "histogram of volume " + id},
                               count);
}

}  // namespace geosis::server
