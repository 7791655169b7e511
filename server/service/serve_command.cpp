#include "server/service/serve_command.h"

#include <algorithm>
#include <map>
#include <memory>
#include <string>

#include "engine/base/parallel.h"
#include "server/service/serve.h"

namespace geosis::server {
namespace {

struct ServeArguments {
  ServeOptions options;
  std::string store = "geosis-store", page = GEOSIS_PAGE_FOLDER, grpc = kDefaultGrpc, admin = kDefaultAdmin;
  int job_seconds = 3600, probe_seconds = 10;
  int drain_seconds = 25, drain_delay_seconds = 0, patience_seconds = 10, idle_seconds = 60;
};

/// Of the processors for one extraction: three quarters, so that others go on beside it.
int share_of_threads(int processors) {
  return std::max((3 * processors + 3) / 4, 1);
}

void add_log_flags(CLI::App& command, ServeOptions& options) {
  const std::map<std::string, LogFormat> formats = {{"text", LogFormat::text}, {"json", LogFormat::json}};
  const std::map<std::string, LogLevel> levels = {
      {"debug", LogLevel::debug}, {"info", LogLevel::info}, {"warning", LogLevel::warning}, {"error", LogLevel::error}};
  // Without the transformer's own description, which shows the numbers behind the names.
  command.add_option("--log-format", options.log_format, "of the lines on stderr")
      ->transform(CLI::CheckedTransformer(formats).description(""))
      ->type_name("text|json")
      ->default_str("text");
  command.add_option("--log-level", options.log_level, "least level of lines")
      ->transform(CLI::CheckedTransformer(levels).description(""))
      ->type_name("debug|info|warning|error")
      ->default_str("info");
}

}  // namespace

Command add_serve_command(CLI::App& app) {
  auto& command =
      *app.add_subcommand("serve", "Serve volumes and extractions over HTTP and gRPC, and the page that shows them");
  auto arguments = std::make_shared<ServeArguments>();
  ServeOptions& options = arguments->options;
  options.threads = share_of_threads(default_threads());
  const auto flag = [&](const char* name, auto& value, const char* help) {
    return command.add_option(name, value, help)->capture_default_str();
  };
  flag("--listen", options.listen, "HOST:PORT; port 0 = any that is free")->type_name("ADDRESS");
  flag("--grpc", arguments->grpc, "HOST:PORT of the gRPC door; off = none")->type_name("ADDRESS");
  auto* certificate = flag("--tls-cert", options.tls_certificate, "certificate chain; with it the doors speak TLS");
  auto* key = flag("--tls-key", options.tls_key, "the certificate's key");
  certificate->type_name("PEM")->needs(key);
  key->type_name("PEM")->needs(certificate);
  flag("--grpc-client-ca", options.grpc_client_authorities,
       "authorities; gRPC clients must show a certificate of theirs")
      ->type_name("PEM")
      ->needs(certificate);
  flag("--store", arguments->store, "folder of everything that is kept")->type_name("DIR");
  flag("--store-limit", options.store_limit,
       "bytes that the store may take; results used longest ago make room, volumes do not; 0 = no limit")
      ->type_name("BYTES");
  flag("--threads", options.threads, "threads that one extraction may use")->check(CLI::Range(1, 1024));
  flag("--workers", options.workers, "extractions at one time")->check(CLI::Range(1, 1024));
  flag("--queued", options.queued, "extractions that may wait; more are refused")->check(CLI::Range(1, 1'000'000));
  flag("--queued-per-tenant", options.queued_per_tenant, "of these in the name of one tenant")
      ->check(CLI::Range(1, 1'000'000));
  flag("--job-seconds", arguments->job_seconds, "longest that one extraction may take")
      ->check(CLI::Range(1, 1'000'000));
  flag("--memory", options.memory_bytes, "that computing may take, by estimate; 0 = 70 % of what is there")
      ->type_name("BYTES");
  flag("--max-body", options.max_body_bytes, "largest upload")->type_name("BYTES");
  flag("--connections", options.connections, "clients at one time; of gRPC a sixteenth")
      ->check(CLI::Range(1, 1'000'000));
  flag("--peer-connections", options.connections_per_peer, "of them from one address; a proxy is one address")
      ->check(CLI::Range(1, 1'000'000));
  flag("--patience-seconds", arguments->patience_seconds, "for a request's head; minimum rates are judged as long")
      ->check(CLI::Range(1, 3600));
  flag("--idle-seconds", arguments->idle_seconds, "that a connection may stay open between requests")
      ->check(CLI::Range(1, 3600));
  command.add_option("--auth", options.auth, "none = anybody may call; api_keys FILE = whose key the file has")
      ->type_name("none | api_keys FILE")
      ->expected(1, 2);
  flag("--admin", arguments->admin, "HOST:PORT of /metrics, /livez and /readyz; off = nowhere")->type_name("ADDRESS");
  flag("--probe-seconds", arguments->probe_seconds,
       "time between questions of the gRPC door for its own health; after three without an answer /livez fails")
      ->check(CLI::Range(1, 3600));
  add_log_flags(command, options);
  command.add_option("--cors-origin", options.cors_origins, "origins whose pages may call")->type_name("ORIGIN");
  flag("--page", arguments->page, "folder of the built page")->type_name("DIR");
  flag("--drain-seconds", arguments->drain_seconds, "how long running answers may take after SIGTERM")
      ->check(CLI::Range(0, 3600));
  flag("--drain-delay-seconds", arguments->drain_delay_seconds,
       "time after SIGTERM in which /readyz fails and all calls are still taken, before that")
      ->check(CLI::Range(0, 3600));
  return [arguments]() -> Result<void> {
    arguments->options.store = arguments->store;
    arguments->options.page = arguments->page;
    arguments->options.grpc = arguments->grpc == "off" ? "" : arguments->grpc;
    arguments->options.admin = arguments->admin == "off" ? "" : arguments->admin;
    arguments->options.patience = std::chrono::seconds(arguments->patience_seconds);
    arguments->options.idle = std::chrono::seconds(arguments->idle_seconds);
    arguments->options.longest = std::chrono::seconds(arguments->job_seconds);
    arguments->options.probe_interval = std::chrono::seconds(arguments->probe_seconds);
    arguments->options.drain = std::chrono::seconds(arguments->drain_seconds);
    arguments->options.drain_delay = std::chrono::seconds(arguments->drain_delay_seconds);
    return serve(arguments->options);
  };
}

}  // namespace geosis::server
