#pragma once

#include "server/app/extractions/extractions.h"
#include "server/jobs/job_queue.h"
#include "server/jobs/memory_budget.h"
#include "server/log/log.h"
#include "server/metrics/metrics.h"

namespace geosis::server {

/// All families of the service; docs/operating.md explains them.
std::vector<Metrics::Family> service_families();

/// Counts stages and cache hits, and writes a line for every extraction.
ExtractionEvents counted_events(Metrics& metrics, Log& log);

/// Brings the numbers up to date that are read rather than counted: queue, memory.
void update_gauges(Metrics& metrics, JobQueue& queue, const MemoryBudget& memory);

}  // namespace geosis::server
