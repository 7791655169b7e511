#include <cctype>
#include <fstream>
#include <iterator>
#include <map>
#include <utility>

#include <openapi_text.h>

#include "engine/pipeline/reconstruct.h"
#include "server/http/error_reply.h"
#include "server/http/json_reply.h"
#include "server/http/routes.h"

namespace geosis::server::http {
namespace {

Reply text_reply(const char* type, std::string body) {
  Reply reply;
  reply.headers = {{"Content-Type", type}, {"Cache-Control", "no-cache"}};
  reply.body = std::move(body);
  return reply;
}

Reply ready(Services services) {
  const auto listed = services.store.children("default/");
  if (!listed) return error_reply({ErrorCode::unavailable, "the store does not answer: " + listed.error().message});
  return json_reply(200, {{"ready", true}, {"queued", services.queue.depth()}});
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

void add_service_routes(Router& router, Services services, const std::filesystem::path& page) {
  router.get("/livez", [](const Request&) { return text_reply("text/plain", "ok\n"); });
  router.get("/readyz", [services](const Request&) { return ready(services); });
  router.get("/version", [](const Request&) { return json_reply(200, version_document()); });
  router.get("/openapi.yaml", [](const Request&) { return text_reply("application/yaml", kOpenapiText); });

  for (auto& [name, content] : read_page(page)) {
    const std::string type = media_type(std::filesystem::path(name).extension().string());
    const auto serve = [type, content](const Request&) { return text_reply(type.c_str(), content); };
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
