#include "server/service/doors.h"

#include <algorithm>
#include <utility>

#include "server/net/listener.h"
#include "server/service/descriptor_limit.h"

namespace geosis::server {
namespace {

/// Handlers read the store and never wait for results: a few more than processors.
constexpr std::size_t kHandlerThreads = 16;

/// Connections of gRPC carry many calls each, and cost more.
constexpr std::size_t kHttpToGrpcConnections = 16;

http::FrontOptions front_options(const ServeOptions& options) {
  http::FrontOptions front;
  front.listen = options.listen;
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

http::Router routes_of(const Tenants& tenants, http::ReplyCache& kept, const http::HealthChecks& checks,
                       const std::filesystem::path& page) {
  http::Router router;
  const http::ServicesOf services_of = [&tenants, &kept](const http::Request& request) {
    return http::Services{tenants.services(request.tenant), kept};
  };
  http::add_volume_routes(router, services_of);
  http::add_grid_routes(router, services_of);
  http::add_extraction_routes(router, services_of);
  http::add_result_routes(router, services_of);
  http::add_service_routes(router, checks, page);
  return router;
}

Error about_grpc(const Error& error) {
  if (error.code != ErrorCode::unavailable) return error;
  return {error.code, error.message + "; --grpc HOST:PORT takes another address for gRPC, --grpc off none"};
}

Result<void> check_address(const std::string& address) {
  if (address.empty()) return {};
  auto listener = Listener::open(address);
  if (!listener) return std::move(listener).error();
  return {};
}

}  // namespace

Result<void> check_addresses(const ServeOptions& options) {
  if (auto free = check_address(options.listen); !free) return free;
  if (auto free = check_address(options.grpc); !free) return about_grpc(free.error());
  return options.admin == kDefaultAdmin ? Result<void>{} : check_address(options.admin);
}

Result<std::unique_ptr<TlsCertificates>> open_tls_certificates(const ServeOptions& options, Log& log) {
  if (options.tls_certificate.empty()) return std::unique_ptr<TlsCertificates>();
  return TlsCertificates::read(
      {.certificate = options.tls_certificate,
       .key = options.tls_key,
       .client_authorities = options.grpc_client_authorities},
      [&log](const std::optional<Error>& problem) {
        if (problem)
          log.write(LogLevel::warning, "certificates not renewed", {{"problem", problem->message}});
        else
          log.write(LogLevel::info, "certificates renewed", {});
      });
}

Result<std::unique_ptr<http::Front>> start_front(const ServeOptions& options, const Tenants& tenants,
                                                 http::ReplyCache& kept, const http::HealthChecks& checks,
                                                 http::Middleware& gate, Slots& uploads,
                                                 TlsCertificates* certificates) {
  http::FrontOptions door = front_options(options);
  door.certificates = certificates;
  door.middleware = &gate;
  door.uploads = &uploads;
  return http::Front::start(door, routes_of(tenants, kept, checks, options.page));
}

Result<std::unique_ptr<rpc::Door>> start_grpc(const ServeOptions& options, const Tenants& tenants, rpc::CallGate& gate,
                                              Slots& uploads, Log& log, HeapTrimmer& trim,
                                              TlsCertificates* certificates) {
  if (options.grpc.empty()) return std::unique_ptr<rpc::Door>();
  raise_descriptor_limit();
  rpc::DoorOptions door;
  door.listen = options.grpc;
  door.certificates = certificates;
  door.upload_bytes = options.max_body_bytes;
  door.connections = std::max(options.connections / kHttpToGrpcConnections, std::size_t{1});
  door.connections_per_peer = std::max(options.connections_per_peer / kHttpToGrpcConnections, std::size_t{1});
  door.patience = options.patience;
  door.probe_interval = options.probe_interval;
  auto started =
      rpc::Door::start(door, {.services_of = [&tenants](const std::string& tenant) { return tenants.services(tenant); },
                              .gate = gate,
                              .uploads = uploads,
                              .say =
                                  [&log](const std::string& line) {
                                    log.write(LogLevel::debug, "grpc", {{"says", line}});
                                  },
                              .give_back = [&trim] { trim(); }});
  if (!started) return about_grpc(started.error());
  return started;
}

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

}  // namespace geosis::server
