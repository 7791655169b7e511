#pragma once

#include <functional>
#include <memory>
#include <string>

#include "engine/base/result.h"
#include "server/grpc/door.h"
#include "server/http/front.h"
#include "server/http/routes/routes.h"
#include "server/http/routing/reply_cache.h"
#include "server/jobs/slots.h"
#include "server/log/log.h"
#include "server/net/tls_certificates.h"
#include "server/service/heap.h"
#include "server/service/serve.h"
#include "server/service/tenants.h"

namespace geosis::server {

// The doors of a server as its options want them. What they are given outlives them. errors: those of the doors.

/// The certificates of the options' files; null when there are none. The log tells when they are renewed.
Result<std::unique_ptr<TlsCertificates>> open_tls_certificates(const ServeOptions& options, Log& log);

/// Whether the doors' addresses are free just now. errors   those of Listener::open.
Result<void> check_addresses(const ServeOptions& options);

/// certificates   null = plain.
Result<std::unique_ptr<http::Front>> start_front(const ServeOptions& options, const Tenants& tenants,
                                                 http::ReplyCache& kept, const http::HealthChecks& checks,
                                                 http::Middleware& gate, Slots& uploads, TlsCertificates* certificates);

/// Null when the options want none.
Result<std::unique_ptr<rpc::Door>> start_grpc(const ServeOptions& options, const Tenants& tenants, rpc::CallGate& gate,
                                              Slots& uploads, Log& log, HeapTrimmer& trim,
                                              TlsCertificates* certificates);

/// Metrics and probes. Null where there is none.
Result<std::unique_ptr<http::Front>> start_admin(const ServeOptions& options, const http::HealthChecks& checks,
                                                 std::function<std::string()> metrics, Log& log);

}  // namespace geosis::server
