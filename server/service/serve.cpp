#include "server/service/serve.h"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string_view>
#include <thread>
#include <utility>

#include "server/app/extractions.h"
#include "server/app/volumes.h"
#include "server/http/front.h"
#include "server/http/routes.h"
#include "server/jobs/job_queue.h"
#include "server/jobs/memory_budget.h"
#include "server/jobs/memory_limit.h"
#include "server/service/descriptor_limit.h"
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

Result<void> check_exposure(const ServeOptions& options) {
  if (!options.auth.empty() && options.auth != "none") {
    return Error{ErrorCode::unsupported, "--auth " + options.auth + ": this version knows only none"};
  }
  if (is_loopback(options.listen) || options.auth == "none") return {};
  return Error{ErrorCode::invalid_argument,
               "--listen " + options.listen + ": not a loopback address; --auth none lets anybody in who reaches it"};
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

JobQueueOptions queue_options(const ServeOptions& options, MemoryBudget& memory) {
  return {.workers = options.workers,
          .preview_workers = 1,
          .most_batch = std::max(options.workers - 1, 1),
          .capacity = static_cast<std::size_t>(options.queued),
          .tenant_capacity = static_cast<std::size_t>(options.queued_per_tenant),
          .longest = options.longest,
          .budget = &memory};
}

std::string host_of(const std::string& listen) {
  return listen.substr(0, listen.rfind(':'));
}

}  // namespace

Result<void> serve(const ServeOptions& options) {
  if (auto safe = check_exposure(options); !safe) return safe;
  StopSignals signals;  // before the first thread starts, so that every thread inherits the mask
  const auto store = open_dir_store(options.store);
  if (!store) return store.error();
  const auto memory_bytes = memory_to_use(options);
  if (!memory_bytes) return memory_bytes.error();
  MemoryBudget memory(*memory_bytes);
  Volumes volumes(**store, kTenant, options.threads);
  JobQueue queue(queue_options(options, memory));
  Extractions extractions(**store, volumes, queue, kTenant, options.threads);

  http::Router router;
  http::ReplyCache kept(kKeptBytes);
  const http::Services services{**store, volumes, extractions, queue, memory, kept};
  const http::ServicesOf services_of = [services](const http::Request&) { return services; };
  http::add_volume_routes(router, services_of);
  http::add_extraction_routes(router, services_of);
  http::add_result_routes(router, services_of);
  http::add_service_routes(router, services, options.page);
  auto front = http::Front::start(front_options(options), std::move(router));
  if (!front) return std::move(front).error();
  std::printf("listening on %s://%s:%u\n", options.tls_certificate.empty() ? "http" : "https",
              host_of(options.listen).c_str(), unsigned{(*front)->port()});
  std::fflush(stdout);

  signals.wait();
  std::fprintf(stderr, "geosis: finishing what runs; a second signal stops at once\n");
  drain_and_stop(**front, queue, signals, options.drain);
  return {};
}

}  // namespace geosis::server
