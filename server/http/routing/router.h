#pragma once

#include <map>
#include <string>
#include <variant>
#include <vector>

#include "server/http/routing/exchange.h"
#include "server/http/wire/head_parser.h"
#include "server/http/wire/target_matcher.h"

namespace geosis::server::http {

/// Which handler answers which method and path.
///
///     Router routes;
///     routes.get("/v1/volumes/([^/]+)", [&](const Request& request) { return show(request.captures[0]); })
///           .upload("/v1/volumes", [&](const Request& request, BodyReader& body) { return store(body); });
///
/// Patterns are TargetMatcher's; the first one added that matches decides, so one text must stand for one resource in
/// all its methods. GET handlers answer HEAD too. Built once, then read by any
/// number of threads.
class Router {
 public:
  Router& get(const std::string& pattern, Handler handler);
  /// quick   asked first.
  Router& get(const std::string& pattern, Handler handler, QuickHandler quick);
  Router& post(const std::string& pattern, Handler handler);
  Router& patch(const std::string& pattern, Handler handler);
  Router& remove(const std::string& pattern, Handler handler);  ///< DELETE
  /// POST with a body of any size, on a thread of its own.
  Router& upload(const std::string& pattern, UploadHandler handler);

  /// Only the path exists: what OPTIONS asks about, and what 405 tells.
  struct NoHandler {};
  struct Resolved {
    Request request;
    std::variant<NoHandler, Refusal, const Handler*, const UploadHandler*> target;
    const QuickHandler* quick = nullptr;
    std::string allowed;  ///< the path's methods, comma separated; empty = there is no such path
  };
  /// The request without its body, and who answers it.
  Resolved resolve(const Head& head) const;

 private:
  using AnyHandler = std::variant<Handler, UploadHandler>;
  struct Resource {
    std::string pattern, route;
    std::map<std::string, AnyHandler> handlers;  ///< by method
    QuickHandler quick;                          ///< of GET

    std::string allowed() const;
  };

  Resource& resource_of(const std::string& pattern);
  Router& add(const std::string& method, const std::string& pattern, AnyHandler handler);
  void find_handler(const Resource& resource, Resolved& resolved) const;

  std::vector<Resource> resources_;  ///< by the matcher's number of their pattern
  TargetMatcher matcher_;
};

}  // namespace geosis::server::http
