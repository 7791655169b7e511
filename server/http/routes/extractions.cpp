#include <charconv>
#include <chrono>
#include <utility>

#include "server/app/extractions/extraction_feed.h"
#include "server/app/extractions/result_streams.h"
#include "server/app/volumes/uploads.h"
#include "server/documents/request.h"
#include "server/http/connections/pending_replies.h"
#include "server/http/routes/routes.h"
#include "server/http/routes/upload_options.h"
#include "server/http/routing/error_reply.h"
#include "server/http/routing/json_reply.h"
#include "server/http/routing/parameters.h"
#include "server/http/uploads/received_file.h"

namespace geosis::server::http {
namespace {

constexpr const char* kBoundary = "geosis-9d1c7a52e6";  // long enough not to occur in a part by chance
constexpr const char* kMultipart = "multipart/mixed";

Priority priority_of(const Request& request) {
  return header(request, "priority") == "batch" ? Priority::batch : Priority::interactive;
}

Reply stream_reply(std::unique_ptr<ByteStream> stream, std::string type) {
  Reply reply;
  reply.headers = {{"Content-Type", std::move(type)}, {"Cache-Control", "no-store"}};
  reply.stream = std::move(stream);
  return reply;
}

Reply level_stream_reply(std::shared_ptr<Extraction> extraction, std::function<void()> abandoned) {
  return stream_reply(level_stream(std::move(extraction), kBoundary, std::move(abandoned)),
                      std::string(kMultipart) + "; boundary=" + kBoundary);
}

Reply accepted(const Extraction& extraction) {
  const bool is_done = extraction.snapshot().state == JobState::done;
  Reply reply = json_reply(is_done ? 200 : 202, resource_document(extraction));
  reply.headers.emplace_back("Location", "/v1/extractions/" + extraction.identity().id);
  return reply;
}

Reply create(Services services, const Request& request) {
  if (auto known = only_parameters(request, {"dry_run"}); !known) return error_reply(known.error());
  const auto is_dry = flag_parameter(request, "dry_run", false);
  if (!is_dry) return error_reply(is_dry.error());
  if (!has_json_body(request)) return not_json();
  const auto wanted = parse_json(request.body);
  if (!wanted) return error_reply({ErrorCode::invalid_argument, "request body: " + wanted.error().message});
  if (*is_dry) {
    const auto estimate = services.extractions.estimate(request.captures[0], *wanted);
    return estimate ? json_reply(200, *estimate) : error_reply(estimate.error());
  }
  const auto extraction =
      services.extractions.create(request.captures[0], *wanted, priority_of(request), request.request_id);
  if (!extraction) return error_reply(extraction.error());
  if (accepts(request, kMultipart)) {
    return level_stream_reply(*extraction, abandonment(*extraction));
  }
  return after_extraction(*extraction, std::chrono::seconds(preference(request).wait_seconds.value_or(0)), accepted);
}

Reply get(Services services, const Request& request) {
  const auto extraction = services.extractions.find(request.captures[0]);
  return extraction ? json_reply(200, resource_document(**extraction)) : error_reply(extraction.error());
}

Reply events(Services services, const Request& request) {
  const auto extraction = services.extractions.find(request.captures[0]);
  if (!extraction) return error_reply(extraction.error());
  const std::string last = header(request, "last-event-id");
  std::uint64_t after = 0;
  const auto [end, problem] = std::from_chars(last.data(), last.data() + last.size(), after);
  if (problem != std::errc{} || end != last.data() + last.size()) after = 0;  // none of ours: from the start
  if (knows_the_end(**extraction, after)) {  // browsers connect again after every end; 204 tells them not to
    Reply reply;
    reply.status = 204;
    return reply;
  }
  return stream_reply(event_stream(*extraction, after), "text/event-stream");
}

Reply stream(Services services, const Request& request) {
  const auto extraction = services.extractions.find(request.captures[0]);
  if (!extraction) return error_reply(extraction.error());
  return level_stream_reply(*extraction, {});
}

Reply remove(Services services, const Request& request) {
  if (auto known = only_parameters(request, {"purge"}); !known) return error_reply(known.error());
  const auto purge = flag_parameter(request, "purge", false);
  if (!purge) return error_reply(purge.error());
  const std::string& id = request.captures[0];
  const auto done = *purge ? services.extractions.purge(id) : services.extractions.withdraw(id);
  if (!done) return error_reply(done.error());
  Reply reply;
  reply.status = 204;
  return reply;
}

/// The request of a one-shot call, from its query.
Result<Json> one_shot_request(const Request& request) {
  const auto text = parameter(request, "range");
  if (!text) return Error{ErrorCode::invalid_argument, "parameter range: expected LOW,HIGH"};
  const auto ends = pair_of("range", *text);
  if (!ends) return ends.error();
  auto range = range_from_text(ends->first, ends->second);
  if (!range) return std::move(range).error();
  Json wanted = {{"range", *std::move(range)}};
  for (const char* name : {"mode", "grid", "space"}) {
    if (const auto value = parameter(request, name)) wanted[name] = *value;
  }
  if (const auto method = parameter(request, "missing")) wanted["missing"] = {{"method", *method}};
  const auto cap = flag_parameter(request, "cap", true);
  if (!cap) return cap.error();
  wanted["cap"] = *cap;
  return wanted;
}

Reply extract(Services services, const Request& request, BodyReader& body) {
  const auto wanted = one_shot_request(request);
  if (!wanted) return error_reply(wanted.error());
  auto options = upload_options(request.query, {"range", "mode", "grid", "space", "cap", "missing"});
  if (!options) return error_reply(options.error());
  const auto memory = memory_to_import(services);
  if (!memory) return error_reply(memory.error());
  const auto received = receive_file(request, body, services.store);
  if (!received) return error_reply(received.error());
  if (auto added = add_form_options(received->fields, *options); !added) return error_reply(added.error());
  std::vector<GridCandidate> candidates;
  NoProgress unwatched;
  const auto extraction = extract_spooled(services, *received->file, *options, *wanted, unwatched, candidates);
  if (!extraction) return upload_refusal(extraction.error(), candidates);
  return level_stream_reply(*extraction, abandonment(*extraction));
}

}  // namespace

void add_extraction_routes(Router& router, const ServicesOf& services) {
  const auto with = [services](auto handler) {
    return [=](const Request& request) { return handler(services(request), request); };
  };
  router.post("/v1/volumes/([^/]+)/extractions", with(create));
  router.upload("/v1/extract", [services](const Request& request, BodyReader& body) {
    return extract(services(request), request, body);
  });
  router.get("/v1/extractions/([^/]+)", with(get));
  router.remove("/v1/extractions/([^/]+)", with(remove));
  router.get("/v1/extractions/([^/]+)/events", with(events));
  router.get("/v1/extractions/([^/]+)/stream", with(stream));
}

}  // namespace geosis::server::http
