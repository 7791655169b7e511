#include "server/http/dispatcher.h"

#include <array>
#include <atomic>
#include <charconv>
#include <random>
#include <utility>

#include "server/http/conditional.h"
#include "server/http/error_reply.h"

namespace geosis::server::http {
namespace {

/// Unique in this process and unlikely elsewhere: a counter that starts at a random place.
std::string new_request_id() {
  static std::atomic<std::uint64_t> next = (std::uint64_t{std::random_device{}()} << 32) | std::random_device{}();
  std::array<char, 16> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), next.fetch_add(1), 16).ptr;
  return std::string(digits.data(), end);
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

Dispatcher::Dispatcher(Router routes, CorsOptions cors) : routes_(std::move(routes)), cors_(std::move(cors)) {}

Router::Resolved Dispatcher::resolve(const Head& head) const {
  Router::Resolved resolved = routes_.resolve(head);
  resolved.request.request_id = new_request_id();
  return resolved;
}

bool Dispatcher::is_upload(const Router::Resolved& resolved) const {
  return std::holds_alternative<const UploadHandler*>(resolved.target);
}

Reply Dispatcher::run(const Router::Resolved& resolved) const {
  const auto* handler = std::get_if<const Handler*>(&resolved.target);
  if (!handler) return finish(resolved.request, answer_without_handler(resolved));
  return finish(resolved.request, guarded([&] { return (**handler)(resolved.request); }));
}

Reply Dispatcher::run_upload(const Router::Resolved& resolved, BodyReader& body) const {
  const auto* handler = std::get_if<const UploadHandler*>(&resolved.target);
  if (!handler) return run(resolved);
  return finish(resolved.request, guarded([&] { return (**handler)(resolved.request, body); }));
}

Reply Dispatcher::resume(const Request& request, PendingReply& pending) const {
  return finish(request, guarded([&] { return pending.finish(); }));
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

Reply Dispatcher::finish(const Request& request, Reply reply) const {
  if (reply.pending) return reply;
  apply_conditions(request, reply);
  if (request.method != "OPTIONS") apply_cors(cors_, request, reply);
  reply.headers.emplace_back("X-Request-Id", request.request_id);
  return reply;
}

}  // namespace geosis::server::http
