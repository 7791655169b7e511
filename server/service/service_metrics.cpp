#include "server/service/service_metrics.h"

#include <string>
#include <utility>

namespace geosis::server {
namespace {

using Kind = Metrics::Kind;

struct Stage {
  const char* name;
  double ExtractionTimings::*seconds;
};

constexpr Stage kStages[] = {
    {"load", &ExtractionTimings::load},         {"grid", &ExtractionTimings::grid},
    {"fill", &ExtractionTimings::fill},         {"extract", &ExtractionTimings::extract},
    {"simplify", &ExtractionTimings::simplify}, {"encode", &ExtractionTimings::encode},
    {"certify", &ExtractionTimings::certify},   {"first_level", &ExtractionTimings::first_level},
    {"total", &ExtractionTimings::total}};

}  // namespace

std::vector<Metrics::Family> service_families() {
  return {{"geosis_http_request_seconds", Kind::histogram, "From a request's complete head to its answer's last byte."},
          {"geosis_http_received_bytes_total", Kind::counter, "Bytes of bodies received."},
          {"geosis_http_sent_bytes_total", Kind::counter, "Bytes of answers sent, heads included."},
          {"geosis_http_connections", Kind::gauge, "Connections that are open."},
          {"geosis_grpc_call_seconds", Kind::histogram, "From a call's metadata to its status."},
          {"geosis_grpc_received_bytes_total", Kind::counter, "Bytes of messages received."},
          {"geosis_grpc_sent_bytes_total", Kind::counter, "Bytes of messages sent."},
          {"geosis_grpc_connections", Kind::gauge, "Connections of the gRPC door that are open."},
          {"geosis_grpc_calls", Kind::gauge, "Calls that run."},
          {"geosis_grpc_floods_total", Kind::counter, "Connections of the gRPC door that were ended for flooding it."},
          {"geosis_jobs_waiting", Kind::gauge, "Jobs that wait for a worker or for memory."},
          {"geosis_jobs_running", Kind::gauge, "Jobs that run."},
          {"geosis_jobs_total", Kind::counter, "Jobs that have ended."},
          {"geosis_jobs_waited_seconds_total", Kind::counter, "Time that jobs have waited before they ran."},
          {"geosis_queue_capacity", Kind::gauge, "Jobs that may wait."},
          {"geosis_memory_budget_bytes", Kind::gauge, "Memory that may be reserved."},
          {"geosis_memory_reserved_bytes", Kind::gauge, "Memory that is reserved, by estimate."},
          {"geosis_extraction_stage_seconds", Kind::histogram, "Of extractions computed here, by stage."},
          {"geosis_extractions_asked_total", Kind::counter, "Extractions asked for; hit = it was there or under way."}};
}

ExtractionEvents counted_events(Metrics& metrics, Log& log) {
  return {.asked =
              [&metrics](bool is_hit) {
                metrics.add("geosis_extractions_asked_total", {{"cache", is_hit ? "hit" : "miss"}});
              },
          .computed =
              [&metrics, &log](const Extraction::Identity& identity, const ExtractionTimings& timings) {
                std::vector<LogField> fields = {{"extraction", identity.id}, {"volume", identity.volume}};
                if (!identity.asked_by.empty()) fields.push_back({"request_id", identity.asked_by});
                for (const Stage& stage : kStages) {
                  metrics.observe("geosis_extraction_stage_seconds", {{"stage", stage.name}}, timings.*stage.seconds);
                  fields.push_back({stage.name, timings.*stage.seconds});
                }
                log.write(LogLevel::info, "extraction computed", fields);
              }};
}

void update_gauges(Metrics& metrics, JobQueue& queue, const MemoryBudget& memory) {
  const JobQueueReport report = queue.report();
  for (std::size_t p = 0; p < report.rows.size(); ++p) {
    const JobQueueReport::Row& row = report.rows[p];
    const std::string priority = name_of(static_cast<Priority>(p));
    metrics.set("geosis_jobs_waiting", {{"priority", priority}}, static_cast<double>(row.waiting));
    metrics.set("geosis_jobs_running", {{"priority", priority}}, static_cast<double>(row.running));
    metrics.set("geosis_jobs_waited_seconds_total", {{"priority", priority}}, row.waited_seconds);
    for (const auto& [outcome, count] :
         {std::pair{"done", row.done}, {"failed", row.failed}, {"cancelled", row.cancelled}}) {
      metrics.set("geosis_jobs_total", {{"priority", priority}, {"outcome", outcome}}, static_cast<double>(count));
    }
  }
  metrics.set("geosis_queue_capacity", {}, static_cast<double>(report.capacity));
  metrics.set("geosis_memory_budget_bytes", {}, static_cast<double>(memory.total()));
  metrics.set("geosis_memory_reserved_bytes", {}, static_cast<double>(memory.reserved()));
}

}  // namespace geosis::server
