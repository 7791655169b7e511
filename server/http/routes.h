#pragma once

#include <filesystem>

#include "server/http/router.h"
#include "server/http/services.h"

namespace geosis::server::http {

/// /v1/volumes and below: upload, list, one, change, remove, histogram, slices.
void add_volume_routes(Router& router, const ServicesOf& services);
/// /v1/volumes/{id}/extractions, /v1/extractions and below, /v1/extract.
void add_extraction_routes(Router& router, const ServicesOf& services);
/// /v1/extractions/{id}/manifest, bodies, lods and below.
void add_result_routes(Router& router, const ServicesOf& services);
/// /livez, /readyz, /version, /openapi.yaml, and the page.
///
/// page   folder of the built page; where it is absent, / says so.
void add_service_routes(Router& router, Services services, const std::filesystem::path& page);

}  // namespace geosis::server::http
