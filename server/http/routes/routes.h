#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/http/routes/services.h"
#include "server/http/routing/router.h"

namespace geosis::server::http {

/// /v1/volumes and below: upload, list, one, change, remove, histogram, slices.
void add_volume_routes(Router& router, const ServicesOf& services);
/// /v1/volumes/{id}/grids and below.
void add_grid_routes(Router& router, const ServicesOf& services);
/// /v1/volumes/{id}/extractions, /v1/extractions and below, /v1/extract.
void add_extraction_routes(Router& router, const ServicesOf& services);
/// /v1/extractions/{id}/manifest, bodies, lods and below.
void add_result_routes(Router& router, const ServicesOf& services);
/// What probes ask: why this server should get no requests (empty = it should), and why it should be started again.
struct HealthChecks {
  std::function<std::vector<std::string>()> not_ready;
  std::function<std::optional<std::string>()> not_alive;
  std::function<std::size_t()> queued;
};

/// /livez and /readyz.
void add_health_routes(Router& router, const HealthChecks& health);
/// /metrics.
///
/// text   what it says, in Prometheus' text exposition.
void add_metrics_route(Router& router, std::function<std::string()> text);
/// /livez, /readyz, /version, /openapi.yaml, and the page.
///
/// page   folder of the built page; where it is absent, / says so.
void add_service_routes(Router& router, const HealthChecks& health, const std::filesystem::path& page);

}  // namespace geosis::server::http
