#include "server/service/serve.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "server/app/limited_store.h"
#include "server/auth/api_keys.h"
#include "server/jobs/job_queue.h"
#include "server/jobs/memory_budget.h"
#include "server/jobs/memory_limit.h"
#include "server/metrics/metrics.h"
#include "server/service/call_gate.h"
#include "server/service/doors.h"
#include "server/service/health.h"
#include "server/service/heap.h"
#include "server/service/request_gate.h"
#include "server/service/service_metrics.h"
#include "server/service/stop_signals.h"
#include "server/service/tenants.h"
#include "server/store/dir_store.h"

namespace geosis::server {
namespace {

constexpr const char* kTenant = "default";
constexpr std::uint64_t kLeastMemory = std::uint64_t{128} << 20;
constexpr std::size_t kUploadThreads = 32;       ///< of all doors
constexpr std::size_t kKeptBytes = 64 << 20;     ///< of levels, to be answered from memory
constexpr std::chrono::seconds kLongestStop{3};  ///< after the time for finishing is over

bool is_loopback(std::string_view listen) {
  return listen.starts_with("127.") || listen.starts_with("localhost:") || listen.starts_with("[::1]:");
}

/// What is too big for memory and has no name (samples laid out along layers, volumes of one-shot calls) lies on the
/// store's disk: /tmp may be small, or memory itself. Before any thread begins. Whoever sets TMPDIR knows better.
void keep_temporary_files_in(const std::filesystem::path& store) {
  ::setenv("TMPDIR", (std::filesystem::absolute(store) / "staging").c_str(), 0);
}

/// Who may call: the keys, or nothing where anybody may. What others reach must be said to be open.
Result<std::optional<ApiKeys>> read_keys(const ServeOptions& options) {
  const std::vector<std::string>& auth = options.auth;
  if (auth.size() == 2 && auth[0] == "api_keys") {
    auto keys = ApiKeys::read(auth[1]);
    if (!keys) return std::move(keys).error();
    return std::optional(*std::move(keys));
  }
  const bool is_none = auth.size() == 1 && auth[0] == "none";
  if (!auth.empty() && !is_none) {
    return Error{ErrorCode::invalid_argument, "--auth " + auth[0] + ": expected none, or api_keys and a file"};
  }
  for (const std::string& address : {options.listen, options.grpc, options.admin}) {
    if (is_none || address.empty() || is_loopback(address)) continue;
    return Error{ErrorCode::invalid_argument,
                 address +
                     ": not a loopback address; give --auth api_keys FILE (geosis key makes keys), or --auth none, "
                     "which lets anybody in who reaches it"};
  }
  return std::optional<ApiKeys>();
}

/// What --memory says, or 70 % of what the control group and the machine allow.
Result<std::uint64_t> memory_to_use(const ServeOptions& options) {
  const std::uint64_t bytes = options.memory_bytes > 0 ? options.memory_bytes : memory_limit() / 10 * 7;
  if (bytes >= kLeastMemory) return bytes;
  return Error{ErrorCode::invalid_argument, "--memory " + std::to_string(bytes) + ": at least " +
                                                std::to_string(kLeastMemory) + " bytes are needed"};
}

/// What was computed has its own line; this is for what was not.
void log_end(Log& log, const JobEnd& end) {
  if (end.status.state == JobState::done) return;
  std::vector<LogField> fields = {
      {"what", end.demand.what}, {"tenant", end.demand.tenant}, {"seconds", end.took.count()}};
  if (end.status.error) {
    fields.push_back({"code", name_of(end.status.error->code)});
    fields.push_back({"problem", end.status.error->message});
  }
  const bool has_failed = end.status.state == JobState::failed;
  log.write(has_failed ? LogLevel::warning : LogLevel::info, has_failed ? "job failed" : "job cancelled", fields);
}

JobQueueOptions queue_options(const ServeOptions& options, MemoryBudget& memory, HeapTrimmer& trim, Log& log) {
  return {.workers = options.workers,
          .preview_workers = 1,
          .most_batch = std::max(options.workers - 1, 1),
          .capacity = static_cast<std::size_t>(options.queued),
          .tenant_capacity = static_cast<std::size_t>(options.queued_per_tenant),
          .longest = options.longest,
          .budget = &memory,
          .after_job = [&trim, &log](const JobEnd& end) {
            log_end(log, end);
            trim();
          }};
}

std::string host_of(const std::string& listen) {
  return listen.substr(0, listen.rfind(':'));
}

/// Lets everything finish until the time is over, then stops the work, for which handlers may wait, and the doors.
void drain_and_stop(http::Front& front, rpc::Door* grpc, JobQueue& queue, std::chrono::milliseconds grace) {
  const auto end = std::chrono::steady_clock::now() + grace;
  {
    std::jthread beside([&] {
      if (grpc) grpc->drain(grace);
    });
    front.drain(grace);
  }
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
  queue.drain(std::max(left, std::chrono::milliseconds(0)));
  queue.stop();
  if (grpc) grpc->stop();
  front.stop();
}

void say_where(const ServeOptions& options, const http::Front& front, const rpc::Door* grpc) {
  const bool is_tls = !options.tls_certificate.empty();
  std::printf("listening on %s://%s:%u\n", is_tls ? "https" : "http", host_of(options.listen).c_str(),
              unsigned{front.port()});
  if (grpc) {
    std::printf("listening on %s://%s:%u\n", is_tls ? "grpcs" : "grpc", host_of(options.grpc).c_str(),
                unsigned{grpc->port()});
  }
  std::fflush(stdout);
}

}  // namespace

Result<void> serve(const ServeOptions& options) {
  share_heap_arenas();
  const auto keys = read_keys(options);
  if (!keys) return keys.error();
  StopSignals signals;  // before the first thread starts
  Log log(options.log_format, options.log_level);
  const auto certificates = open_tls_certificates(options, log);
  if (!certificates) return certificates.error();
  const auto memory_bytes = memory_to_use(options);
  if (!memory_bytes) return memory_bytes.error();
  // Before the store: who cannot serve leaves no new folder behind.
  if (auto free = check_addresses(options); !free) return free;
  Metrics metrics(service_families());
  auto opened = open_dir_store(options.store);
  if (!opened) return std::move(opened).error();
  keep_temporary_files_in(options.store);
  LimitedStore store(*std::move(opened), {.limit = options.store_limit});
  store.on_damage([&log](const BlobKey& key, const std::string& why) {
    log.write(LogLevel::error, "damage in the store", {{"blob", key}, {"why", why}});
  });
  MemoryBudget memory(*memory_bytes);
  HeapTrimmer trim;
  JobQueue queue(queue_options(options, memory, trim, log));
  const std::vector<std::string> names = *keys ? (*keys)->tenants() : std::vector<std::string>{kTenant};
  Tenants tenants(store, queue, memory, options.threads, names);
  tenants.on_events(counted_events(metrics, log));
  tenants.keep_house();
  Health health(store, queue);
  const http::HealthChecks checks = {[&] { return health.not_ready(); }, [&] { return health.not_alive(); },
                                     [&] { return queue.depth(); }};
  Slots uploads(kUploadThreads);

  KeyedCallGate call_gate(*keys, queue, log, metrics);
  const auto grpc = start_grpc(options, tenants, call_gate, uploads, log, trim, certificates->get());
  if (!grpc) return grpc.error();
  if (*grpc) health.ask_also([&door = **grpc] { return door.not_alive(); });

  RequestGate gate(*keys, queue, log, metrics);
  http::ReplyCache kept(kKeptBytes);
  auto front = start_front(options, tenants, kept, checks, gate, uploads, certificates->get());
  if (!front) return std::move(front).error();
  const auto text = [&] {
    update_gauges(metrics, queue, memory);
    metrics.set("geosis_http_connections", {}, static_cast<double>((*front)->connections()));
    if (*grpc) metrics.set("geosis_grpc_connections", {}, static_cast<double>((*grpc)->connections()));
    if (*grpc) metrics.set("geosis_grpc_calls", {}, static_cast<double>((*grpc)->calls()));
    return metrics.text();
  };
  const auto admin = start_admin(options, checks, text, log);
  if (!admin) return admin.error();
  say_where(options, **front, grpc->get());

  signals.wait();
  std::fprintf(stderr, "geosis: finishing what runs; a second signal stops at once\n");
  health.set_draining();
  if (*grpc) (*grpc)->set_not_serving();
  stop_or_exit(signals, options.drain_delay + options.drain + kLongestStop, [&] {
    std::this_thread::sleep_for(options.drain_delay);
    drain_and_stop(**front, grpc->get(), queue, options.drain);
  });
  return {};
}

}  // namespace geosis::server
