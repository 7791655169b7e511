#include <cctype>
#include <fstream>
#include <iterator>
#include <map>
#include <utility>

#include <openapi_text.h>

#include "engine/pipeline/reconstruct.h"
#include "server/http/routes/routes.h"
#include "server/http/routing/error_reply.h"
#include "server/http/routing/json_reply.h"

namespace geosis::server::http {
namespace {

Reply text_reply(const char* type, std::string body) {
  Reply reply;
  reply.headers = {{"Content-Type", type}, {"Cache-Control", "no-cache"}};
  reply.body = std::move(body);
  return reply;
}

Reply alive(const HealthChecks& health) {
  if (auto reason = health.not_alive()) return error_reply({ErrorCode::unavailable, *std::move(reason)});
  return text_reply("text/plain", "ok\n");
}

Reply ready(const HealthChecks& health) {
  std::string reasons;
  for (const std::string& reason : health.not_ready()) reasons += (reasons.empty() ? "" : "; ") + reason;
  if (!reasons.empty()) return error_reply({ErrorCode::unavailable, reasons});
  return json_reply(200, {{"ready", true}, {"queued", health.queued()}});
}

Json version_document() {
  return {{"name", "geosis"}, {"version", GEOSIS_VERSION}, {"result_version", kResultVersion}};
}

const char* media_type(const std::string& extension) {
  static const std::map<std::string, const char*> types = {{".html", "text/html; charset=utf-8"},
                                                           {".js", "text/javascript"},
                                                           {".css", "text/css"},
                                                           {".wasm", "application/wasm"},
                                                           {".json", "application/json"},
                                                           {".svg", "image/svg+xml"},
                                                           {".png", "image/png"},
                                                           {".map", "application/json"}};
  const auto found = types.find(extension);
  return found == types.end() ? "application/octet-stream" : found->second;
}

/// The pattern of a path that is this name alone.
std::string pattern_of(const std::string& name) {
  std::string pattern = "/";
  for (const char c : name) {
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '/' && c != '-' && c != '_') pattern += '\\';
    pattern += c;
  }
  return pattern;
}

/// The built page's files, read once: only these names are ever served.
std::map<std::string, std::string> read_page(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, ignored)) {
    if (!entry.is_regular_file(ignored)) continue;
    std::ifstream file(entry.path(), std::ios::binary);
    files[entry.path().lexically_relative(folder).generic_string()] = {std::istreambuf_iterator<char>(file), {}};
  }
  return files;
}

}  // namespace

void add_health_routes(Router& router, const HealthChecks& health) {
  router.get("/livez", [health](const Request&) { return alive(health); });
  router.get("/readyz", [health](const Request&) { return ready(health); });
}

void add_metrics_route(Router& router, std::function<std::string()> text) {
  router.get("/metrics", [text = std::move(text)](const Request&) {
    return text_reply("text/plain; version=0.0.4; charset=utf-8", text());
  });
}

void add_service_routes(Router& router, const HealthChecks& health, const std::filesystem::path& page) {
  add_health_routes(router, health);
  router.get("/version", [](const Request&) { return json_reply(200, version_document()); });
  router.get("/openapi.yaml", [](const Request&) { return text_reply("application/yaml", kOpenapiText); });

  for (auto& [name, content] : read_page(page)) {
    const std::string type = media_type(std::filesystem::path(name).extension().string());
    const auto serve = [type, content = content](const Request&) { return text_reply(type.c_str(), content); };
    if (name == "index.html") router.get("/", serve);
    router.get(pattern_of(name), serve);
  }
  if (!std::filesystem::exists(page / "index.html")) {
    router.get("/", [](const Request&) {
      return text_reply("text/plain",
                        "Geosis serves, but its page was not built (viewer/README.md). The API is at /openapi.yaml.\n");
    });
  }
}

}  // namespace geosis::server::http
