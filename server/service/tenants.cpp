#include "server/service/tenants.h"

namespace geosis::server {

Tenants::Tenants(BlobStore& store, JobQueue& queue, MemoryBudget& memory, int threads,
                 const std::vector<std::string>& names)
    : store_(store), queue_(queue), memory_(memory) {
  for (const std::string& name : names) {
    Tenant& tenant = tenants_[name];
    tenant.volumes = std::make_unique<Volumes>(store, name, threads);
    tenant.extractions = std::make_unique<Extractions>(store, *tenant.volumes, queue, name, threads);
  }
}

Services Tenants::services(const std::string& name) const {
  const Tenant& tenant = tenants_.at(name);
  return {store_, *tenant.volumes, *tenant.extractions, queue_, memory_};
}

void Tenants::on_events(const ExtractionEvents& events) {
  for (auto& [name, tenant] : tenants_) tenant.extractions->on_events(events);
}

void Tenants::keep_house() {
  for (auto& [name, tenant] : tenants_) {
    tenant.housekeeping = std::make_unique<Housekeeping>(*tenant.volumes, *tenant.extractions);
  }
}

}  // namespace geosis::server
