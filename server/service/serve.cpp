#include "server/service/serve.h"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "server/app/limited_store.h"
#include "server/auth/api_keys.h"
#include "server/http/front.h"
#include "server/http/routes.h"
#include "server/jobs/job_queue.h"
#include "server/jobs/memory_budget.h"
#include "server/jobs/memory_limit.h"
#include "server/metrics/metrics.h"
#include "server/service/descriptor_limit.h"
#include "server/service/health.h"
#include "server/service/heap.h"
#include "server/service/request_gate.h"
#include "server/service/service_metrics.h"
#include "server/service/tenants.h"
#include "server/store/dir_store.h"

namespace geosis::server {
namespace {

constexpr const char* kTenant = "default";
/// Handlers read the store and never wait for results: a few more than processors.
constexpr std::size_t kHandlerThreads = 16;
constexpr std::uint64_t kLeastMemory = std::uint64_t{128} << 20;
constexpr std::size_t kKeptBytes = 64 << 20;     ///< of levels, to be answered from memory
constexpr std::chrono::seconds kLongestStop{3};  ///< after the time for finishing is over

bool is_loopback(std::string_view listen) {
  return listen.starts_with("127.") || listen.starts_with("localhost:") || listen.starts_with("[::1]:");
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
  for (const std::string& address : {options.listen, options.admin}) {
    if (is_none || address.empty() || is_loopback(address)) continue;
    return Error{ErrorCode::invalid_argument,
                 address +
                     ": not a loopback address; give --auth api_keys FILE (geosis key makes keys), or --auth none, "
                     "which lets anybody in who reaches it"};
  }
  return std::optional<ApiKeys>();
}

/// SIGTERM and SIGINT come to whoever waits for them here, and to no other thread.
class StopSignals {
 public:
  StopSignals() {
    sigemptyset(&set_);
    sigaddset(&set_, SIGTERM);
    sigaddset(&set_, SIGINT);
    pthread_sigmask(SIG_BLOCK, &set_, nullptr);
    std::signal(SIGPIPE, SIG_IGN);
  }
  void wait() {
    int number = 0;
    sigwait(&set_, &number);
  }
  /// True when one came in time.
  bool wait_for(std::chrono::milliseconds time) {
    const std::timespec limit{time.count() / 1000, (time.count() % 1000) * 1'000'000};
    return sigtimedwait(&set_, nullptr, &limit) > 0;
  }

 private:
  sigset_t set_{};
};

/// Lets everything finish until the time is over, then stops the work, for which handlers may wait, and the front. A
/// second signal ends the process at once, and so does work that does not stop: nothing acknowledged is lost by that.
void drain_and_stop(http::Front& front, JobQueue& queue, StopSignals& signals, std::chrono::milliseconds grace) {
  const auto end = std::chrono::steady_clock::now() + grace;
  std::atomic<bool> is_stopped{false};
  std::jthread stopping([&] {
    front.drain(grace);
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
    queue.drain(std::max(left, std::chrono::milliseconds(0)));
    queue.stop();
    front.stop();
    is_stopped = true;
  });
  while (!is_stopped) {
    const bool is_late = std::chrono::steady_clock::now() > end + kLongestStop;
    if (signals.wait_for(std::chrono::milliseconds(20)) || is_late) std::_Exit(EXIT_FAILURE);
  }
}

http::FrontOptions front_options(const ServeOptions& options) {
  http::FrontOptions front;
  front.listen = options.listen;
  front.tls_certificate = options.tls_certificate;
  front.tls_key = options.tls_key;
  front.limits.upload_bytes = options.max_body_bytes;
  // Some descriptors stay for the store: a client must not keep others' files from being opened.
  const std::size_t descriptors = raise_descriptor_limit();
  front.limits.connections = std::min(options.connections, descriptors - descriptors / 4);
  front.limits.connections_per_peer = options.connections_per_peer;
  front.limits.head_deadline = front.limits.rate_window = options.patience;
  front.limits.idle_timeout = options.idle;
  front.cors.origins = options.cors_origins;
  front.handler_threads = kHandlerThreads;
  return front;
}

/// What --memory says, or 70 % of what the control group and the machine allow.
Result<std::uint64_t> memory_to_use(const ServeOptions& options) {
  const std::uint64_t bytes = options.memory_bytes > 0 ? options.memory_bytes : memory_limit() / 10 * 7;
  if (bytes >= kLeastMemory) return bytes;
  return Error{ErrorCode::invalid_argument, "--memory " + std::to_string(bytes) + ": at least " +
                                                std::to_string(kLeastMemory) + " bytes are needed"};
}

JobQueueOptions queue_options(const ServeOptions& options, MemoryBudget& memory, HeapTrimmer& trim) {
  return {.workers = options.workers,
          .preview_workers = 1,
          .most_batch = std::max(options.workers - 1, 1),
          .capacity = static_cast<std::size_t>(options.queued),
          .tenant_capacity = static_cast<std::size_t>(options.queued_per_tenant),
          .longest = options.longest,
          .budget = &memory,
          .after_job = [&trim] { trim(); }};
}

http::Router routes_of(const Tenants& tenants, const http::HealthChecks& checks, const std::filesystem::path& page) {
  http::Router router;
  const http::ServicesOf services_of = [&tenants](const http::Request& request) {
    return tenants.services(request.tenant);
  };
  http::add_volume_routes(router, services_of);
  http::add_extraction_routes(router, services_of);
  http::add_result_routes(router, services_of);
  http::add_service_routes(router, checks, page);
  return router;
}

/// The second door: metrics and probes. Null where there is none.
Result<std::unique_ptr<http::Front>> start_admin(const ServeOptions& options, const http::HealthChecks& checks,
                                                 std::function<std::string()> metrics, Log& log) {
  if (options.admin.empty()) return std::unique_ptr<http::Front>();
  http::Router router;
  http::add_health_routes(router, checks);
  http::add_metrics_route(router, std::move(metrics));
  http::FrontOptions door;
  door.listen = options.admin;
  door.limits.connections = 64;
  door.handler_threads = 2;
  auto front = http::Front::start(door, std::move(router));
  if (!front && options.admin == kDefaultAdmin) {
    log.write(LogLevel::warning, "no metrics: another program has their port",
              {{"address", options.admin}, {"problem", front.error().message}});
    return std::unique_ptr<http::Front>();
  }
  return front;
}

std::string host_of(const std::string& listen) {
  return listen.substr(0, listen.rfind(':'));
}

}  // namespace

Result<void> serve(const ServeOptions& options) {
  share_heap_arenas();
  const auto keys = read_keys(options);
  if (!keys) return keys.error();
  StopSignals signals;  // before the first thread starts, so that every thread inherits the mask
  Log log(options.log_format, options.log_level);
  Metrics metrics(service_families());
  auto opened = open_dir_store(options.store);
  if (!opened) return std::move(opened).error();
  LimitedStore store(*std::move(opened), {.limit = options.store_limit});
  store.on_damage([&log](const BlobKey& key, const std::string& why) {
    log.write(LogLevel::error, "damage in the store", {{"blob", key}, {"why", why}});
  });
  const auto memory_bytes = memory_to_use(options);
  if (!memory_bytes) return memory_bytes.error();
  MemoryBudget memory(*memory_bytes);
  HeapTrimmer trim;
  JobQueue queue(queue_options(options, memory, trim));
  const std::vector<std::string> names = *keys ? (*keys)->tenants() : std::vector<std::string>{kTenant};
  http::ReplyCache kept(kKeptBytes);
  Tenants tenants(store, queue, memory, kept, options.threads, names);
  tenants.on_events(counted_events(metrics, log));
  tenants.keep_house();
  Health health(store, queue);
  RequestGate gate(*keys, queue, log, metrics);

  const http::HealthChecks checks = {[&] { return health.not_ready(); }, [&] { return health.not_alive(); },
                                     [&] { return queue.depth(); }};
  http::FrontOptions door = front_options(options);
  door.middleware = &gate;
  auto front = http::Front::start(door, routes_of(tenants, checks, options.page));
  if (!front) return std::move(front).error();
  const auto text = [&, &open = **front] {
    update_gauges(metrics, queue, memory);
    metrics.set("geosis_http_connections", {}, static_cast<double>(open.connections()));
    return metrics.text();
  };
  const auto admin = start_admin(options, checks, text, log);
  if (!admin) return admin.error();
  std::printf("listening on %s://%s:%u\n", options.tls_certificate.empty() ? "http" : "https",
              host_of(options.listen).c_str(), unsigned{(*front)->port()});
  std::fflush(stdout);

  signals.wait();
  std::fprintf(stderr, "geosis: finishing what runs; a second signal stops at once\n");
  health.set_draining();
  drain_and_stop(**front, queue, signals, options.drain);
  return {};
}

}  // namespace geosis::server
