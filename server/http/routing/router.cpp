#include "server/http/routing/router.h"

#include <algorithm>
#include <utility>

namespace geosis::server::http {
namespace {

Request request_of(const Head& head) {
  Request request;
  request.method = head.method;
  request.path = head.target;
  request.headers = head.headers;
  request.content_length = head.content_length;
  return request;
}

/// The pattern as people read it: /v1/volumes/* for /v1/volumes/([^/]+).
std::string route_of(const std::string& pattern) {
  std::string route;
  int depth = 0;
  for (const char c : pattern) {
    if (c == '(' && depth++ == 0) route += '*';
    if (depth == 0 && c != '\\') route += c;
    if (c == ')') --depth;
  }
  return route;
}

}  // namespace

Router& Router::get(const std::string& pattern, Handler handler) {
  return add("GET", pattern, std::move(handler));
}
Router& Router::get(const std::string& pattern, Handler handler, QuickHandler quick) {
  get(pattern, std::move(handler));
  resource_of(pattern).quick = std::move(quick);
  return *this;
}
Router& Router::post(const std::string& pattern, Handler handler) {
  return add("POST", pattern, std::move(handler));
}
Router& Router::patch(const std::string& pattern, Handler handler) {
  return add("PATCH", pattern, std::move(handler));
}
Router& Router::remove(const std::string& pattern, Handler handler) {
  return add("DELETE", pattern, std::move(handler));
}
Router& Router::upload(const std::string& pattern, UploadHandler handler) {
  return add("POST", pattern, std::move(handler));
}

Router& Router::add(const std::string& method, const std::string& pattern, AnyHandler handler) {
  resource_of(pattern).handlers.insert_or_assign(method, std::move(handler));
  return *this;
}

Router::Resource& Router::resource_of(const std::string& pattern) {
  auto resource = std::find_if(resources_.begin(), resources_.end(),
                               [&](const Resource& candidate) { return candidate.pattern == pattern; });
  if (resource == resources_.end()) {
    resource = resources_.insert(resource, Resource{pattern, route_of(pattern), {}, {}});
    matcher_.add(pattern);
  }
  return *resource;
}

Router::Resolved Router::resolve(const Head& head) const {
  Resolved resolved{request_of(head), Refusal{404, "there is nothing at this path"}, nullptr, {}};
  if (head.target == "*") {
    resolved.allowed = "GET, HEAD, POST, PATCH, DELETE, OPTIONS";
    resolved.target = NoHandler{};
    return resolved;
  }
  auto match = matcher_.match(head.target);
  if (!match) {
    resolved.target = Refusal{400, "the request's target cannot be decoded"};
    return resolved;
  }
  resolved.request.path = std::move(match->path);
  resolved.request.query = std::move(match->query);
  resolved.request.captures = std::move(match->captures);
  if (match->pattern) find_handler(resources_[*match->pattern], resolved);
  return resolved;
}

void Router::find_handler(const Resource& resource, Resolved& resolved) const {
  resolved.allowed = resource.allowed();
  resolved.request.route = resource.route;
  resolved.target = NoHandler{};
  const std::string& method = resolved.request.method;
  const auto found = resource.handlers.find(method == "HEAD" ? "GET" : method);
  if (found == resource.handlers.end()) return;
  if (found->first == "GET" && resource.quick) resolved.quick = &resource.quick;
  std::visit([&](const auto& handler) { resolved.target = &handler; }, found->second);
}

std::string Router::Resource::allowed() const {
  std::string methods;
  for (const auto& [method, handler] : handlers) methods += method + (method == "GET" ? ", HEAD, " : ", ");
  return methods + "OPTIONS";
}

}  // namespace geosis::server::http
