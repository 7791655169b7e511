#include "server/http/routing/dispatcher.h"

#include <string_view>
#include <utility>

#include "server/http/routing/error_reply.h"
#include "server/http/routing/parameters.h"
#include "server/http/wire/conditional.h"
#include "server/net/request_ids.h"

namespace geosis::server::http {
namespace {

constexpr int kClientLeft = 499;

/// A body that is counted as it is read.
class CountedBody final : public BodyReader {
 public:
  explicit CountedBody(BodyReader& body) : body_(body) {}
  Result<std::size_t> read(std::span<std::byte> into) override {
    auto count = body_.read(into);
    if (count) bytes_ += *count;
    return count;
  }
  std::uint64_t bytes() const { return bytes_; }

 private:
  BodyReader& body_;
  std::uint64_t bytes_ = 0;
};

/// Of a body that nobody counted.
std::uint64_t body_bytes(const Request& request) {
  return request.content_length.value_or(request.body.size());
}

/// Tells the middleware of an answer when its last byte has left.
auto teller(Middleware& middleware, Answered answered, Dispatcher::Clock::time_point received) {
  return [&middleware, answered = std::move(answered), received](std::uint64_t bytes, bool is_complete) mutable {
    answered.bytes_out = bytes;
    answered.is_complete = is_complete;
    answered.duration = Dispatcher::Clock::now() - received;
    try {
      middleware.answered(answered);
    } catch (...) {  // a lost line is no reason to lose the connection
    }
  };
}

/// What a key opened is for its holder: with "public" a cache between would show it to whoever asks next.
void keep_to_its_caller(const Request& request, Reply& reply) {
  constexpr std::string_view kPublic = "public";
  if (request.header("authorization") == nullptr) return;
  for (auto& [name, value] : reply.headers) {
    if (name == "Cache-Control" && value.starts_with(kPublic)) value.replace(0, kPublic.size(), "private");
  }
}

template <class Call>
Reply guarded(Call call) {
  try {
    return call();
  } catch (...) {
    return refusal_reply({500, "an unexpected failure; the request was not carried out"});
  }
}

}  // namespace

Dispatcher::Dispatcher(Router routes, CorsOptions cors, Middleware* middleware)
    : routes_(std::move(routes)), cors_(std::move(cors)), middleware_(middleware) {}

Router::Resolved Dispatcher::resolve(const Head& head, Clock::time_point received) const {
  Router::Resolved resolved = routes_.resolve(head);
  Request& request = resolved.request;
  request.received = received;
  request.request_id = request_id_of(header(request, "x-request-id"));
  request.trace_id = trace_id_of(header(request, "traceparent"));
  const bool has_handler =
      !std::holds_alternative<Router::NoHandler>(resolved.target) && !std::holds_alternative<Refusal>(resolved.target);
  if (middleware_ && has_handler) {
    if (auto refusal = middleware_->admit(request)) resolved.target = *std::move(refusal);
  }
  return resolved;
}

bool Dispatcher::is_upload(const Router::Resolved& resolved) const {
  return std::holds_alternative<const UploadHandler*>(resolved.target);
}

std::optional<Reply> Dispatcher::run_quickly(const Router::Resolved& resolved) const {
  if (!resolved.quick || !std::holds_alternative<const Handler*>(resolved.target)) return std::nullopt;
  try {
    auto reply = (*resolved.quick)(resolved.request);
    if (!reply) return std::nullopt;
    return finish(resolved.request, *std::move(reply));
  } catch (...) {  // the handler will say what is wrong
    return std::nullopt;
  }
}

Reply Dispatcher::run(const Router::Resolved& resolved) const {
  const auto* handler = std::get_if<const Handler*>(&resolved.target);
  if (!handler) return finish(resolved.request, answer_without_handler(resolved));
  return finish(resolved.request, guarded([&] { return (**handler)(resolved.request); }), body_bytes(resolved.request));
}

Reply Dispatcher::run_upload(const Router::Resolved& resolved, BodyReader& body) const {
  const auto* handler = std::get_if<const UploadHandler*>(&resolved.target);
  if (!handler) return run(resolved);
  CountedBody counted(body);
  Reply reply = guarded([&] { return (**handler)(resolved.request, counted); });
  return finish(resolved.request, std::move(reply), counted.bytes());
}

Reply Dispatcher::resume(const Request& request, PendingReply& pending) const {
  return finish(request, guarded([&] { return pending.finish(); }), body_bytes(request));
}

Reply Dispatcher::refuse(const Request& request, const Refusal& refusal) const {
  return finish(request, refusal_reply(refusal));
}

Reply Dispatcher::answer_without_handler(const Router::Resolved& resolved) const {
  if (const auto* refusal = std::get_if<Refusal>(&resolved.target)) return refusal_reply(*refusal);
  if (resolved.request.method == "OPTIONS") return options_reply(cors_, resolved.request, resolved.allowed);
  Reply reply = refusal_reply({405, "this path does not take " + resolved.request.method});
  reply.headers.emplace_back("Allow", resolved.allowed);
  return reply;
}

Reply Dispatcher::finish(const Request& request, Reply reply, std::uint64_t bytes_in) const {
  const std::string id =
      request.request_id.empty() ? request_id_of(header(request, "x-request-id")) : request.request_id;
  if (!reply.pending) {
    apply_conditions(request, reply);
    if (request.method != "OPTIONS") apply_cors(cors_, request, reply);
    keep_to_its_caller(request, reply);
    reply.headers.emplace_back("X-Request-Id", id);
  }
  if (!middleware_) return reply;
  for (auto& [name, value] : reply.headers) {
    if (name == "Retry-After") value = std::to_string(middleware_->retry_after_seconds());
  }
  reply.on_written = teller(*middleware_,
                            {.method = request.method,
                             .path = request.path,
                             .route = request.route,
                             .request_id = id,
                             .trace_id = request.trace_id,
                             .tenant = request.tenant,
                             .status = reply.pending ? kClientLeft : reply.status,
                             .bytes_in = bytes_in},
                            request.received);
  return reply;
}

}  // namespace geosis::server::http
