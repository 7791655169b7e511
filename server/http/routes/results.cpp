#include <charconv>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "server/app/extractions/result_streams.h"
#include "server/http/connections/pending_replies.h"
#include "server/http/routes/download_name.h"
#include "server/http/routes/routes.h"
#include "server/http/routing/error_reply.h"
#include "server/http/routing/json_reply.h"

// What an extraction's result is read as: the manifest, files of levels, the bodies.

namespace geosis::server::http {
namespace {

constexpr const char* kImmutable = "public, max-age=31536000, immutable";

/// 409 with the state, for what exists only once the extraction is done.
Reply not_done(const Extraction& extraction) {
  const std::string state = name_of(extraction.snapshot().state);
  return error_reply(
      {ErrorCode::already_exists, "extraction " + extraction.identity().id + ": it is " + state + ", not done"},
      {{"state", state}});
}

Reply manifest(Services services, const Request& request) {
  const auto extraction = services.extractions.find(request.captures[0]);
  if (!extraction) return error_reply(extraction.error());
  const auto now = (*extraction)->snapshot();
  if (!now.manifest) return not_done(**extraction);
  Reply reply = json_reply(200, *now.manifest);
  // Its id names volume, request and result version, of which the manifest is a pure function.
  reply.headers = {{"Content-Type", "application/json"},
                   {"Cache-Control", kImmutable},
                   {"ETag", "\"" + (*extraction)->identity().id + "\""},
                   download_name((*extraction)->identity().id, "manifest.json")};
  return reply;
}

/// How a file is presented.
struct Face {
  const char* type;
  std::pair<std::string, std::string> name;
};

Reply file_reply(Result<LevelFile> file, const Face& face, const std::string& transform) {
  if (!file) return error_reply(file.error());
  Reply reply;
  reply.headers = {
      {"Content-Type", face.type}, {"Cache-Control", kImmutable}, {"ETag", "\"" + file->sha256 + "\""}, face.name};
  if (!transform.empty()) reply.headers.emplace_back("X-Geosis-Transform", transform);
  reply.stream = std::move(file->stream);
  reply.length = file->bytes;
  return reply;
}

/// 404 and 409 as the manifest has them.
Reply bodies(Services services, const Request& request) {
  const auto extraction = services.extractions.find(request.captures[0]);
  if (!extraction) return error_reply(extraction.error());
  if (!(*extraction)->is_done()) return not_done(**extraction);
  const auto answer = [services, id = request.captures[0]] {
    return file_reply(services.extractions.bodies(id), {"application/json", download_name(id, "bodies.json")}, "");
  };
  if (services.extractions.are_bodies_made(request.captures[0])) return answer();
  return after_job(services.extractions.begin_bodies(request.captures[0]), WhenAbandoned::run_on, answer);
}

int small_number(const std::string& digits) {
  int number = -1;
  const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  return problem == std::errc{} ? number : -1;
}

const char* media_type_of(LevelFormat format) {
  switch (format) {
    case LevelFormat::drc:
      return "model/vnd.google.draco";
    case LevelFormat::glb:
      return "model/gltf-binary";
    case LevelFormat::ply:
      return "model/ply";
    case LevelFormat::obj:
      return "model/obj";
    case LevelFormat::stl:
      return "model/stl";
  }
  return "application/octet-stream";
}

std::string name_of(const Request& request) {
  return request.tenant + " " + request.path;
}

/// The file, which from now on is kept in memory if it is not too big.
Reply kept_reply(Services services, const std::string& name, Result<LevelFile> file, const Face& face) {
  if (!file || !services.kept.has_room_for(file->bytes)) {
    const std::string transform = file ? file->transform : "";
    return file_reply(std::move(file), face, transform);
  }
  auto bytes = read_whole(*file);
  if (!bytes) return error_reply(bytes.error());
  const auto body = std::make_shared<const std::string>(*std::move(bytes));
  const std::string transform = file->transform;
  Reply reply = file_reply(std::move(file), face, transform);
  reply.stream.reset();
  reply.length.reset();
  reply.shared = body;
  services.kept.keep(name, {reply.headers, body});
  return reply;
}

/// A file that is kept, of an extraction that still has its result.
std::optional<Reply> reply_from_memory(Services services, const Request& request) {
  auto kept = services.kept.find(name_of(request));
  if (!kept || !services.extractions.has_result(request.captures[0])) return std::nullopt;
  Reply reply;
  reply.headers = std::move(kept->headers);
  reply.shared = std::move(kept->body);
  return reply;
}

Reply level(Services services, const Request& request) {
  const std::string &id = request.captures[0], format = request.captures[2];
  const auto extraction = services.extractions.find(id);
  if (!extraction) return error_reply(extraction.error());
  if (!(*extraction)->is_done()) return not_done(**extraction);
  const LevelFormat wanted = *level_format_of(format);  // the route lets no other through
  const int number = small_number(request.captures[1]);
  const Face face{media_type_of(wanted), download_name(id, "level-" + std::to_string(number) + "." + format)};
  const auto answer = [services, id, number, wanted, face, name = name_of(request)] {
    return kept_reply(services, name, services.extractions.level(id, number, wanted), face);
  };
  if (services.extractions.is_level_made(id, number, wanted)) return answer();
  return after_job(services.extractions.begin_level(id, number, wanted), WhenAbandoned::run_on, answer);
}

Reply part(Services services, const Request& request) {
  const std::string& id = request.captures[0];
  const int level = small_number(request.captures[1]), part = small_number(request.captures[2]);
  const std::string name = "level-" + std::to_string(level) + "-part-" + std::to_string(part) + ".drc";
  return kept_reply(services, name_of(request), services.extractions.part(id, level, part),
                    {media_type_of(LevelFormat::drc), download_name(id, name)});
}

}  // namespace

void add_result_routes(Router& router, const ServicesOf& services) {
  const auto with = [services](auto handler) {
    return [=](const Request& request) { return handler(services(request), request); };
  };
  router.get("/v1/extractions/([^/]+)/manifest", with(manifest));
  router.get("/v1/extractions/([^/]+)/bodies", with(bodies));
  router.get("/v1/extractions/([^/]+)/lods/([0-9]+)\\.(drc|glb|ply|obj|stl)", with(level), with(reply_from_memory));
  router.get("/v1/extractions/([^/]+)/lods/([0-9]+)/parts/([0-9]+)\\.drc", with(part), with(reply_from_memory));
}

}  // namespace geosis::server::http
