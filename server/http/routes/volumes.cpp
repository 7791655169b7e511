#include <charconv>
#include <cmath>
#include <cstring>
#include <utility>

#include "server/app/volumes/uploads.h"
#include "server/app/volumes/volume_calls.h"
#include "server/documents/import_options.h"
#include "server/documents/slice_png.h"
#include "server/documents/volume_document.h"
#include "server/http/connections/pending_replies.h"
#include "server/http/routes/download_name.h"
#include "server/http/routes/routes.h"
#include "server/http/routes/upload_options.h"
#include "server/http/routing/error_reply.h"
#include "server/http/routing/json_reply.h"
#include "server/http/routing/parameters.h"
#include "server/http/uploads/received_file.h"
#include "server/http/wire/content_digest.h"
#include "server/http/wire/form_reader.h"

namespace geosis::server::http {
namespace {

/// Size of the file that the body is, when the file can be imported while it arrives.
std::optional<std::uint64_t> arriving(const Request& request, const ImportOptions& options) {
  if (form_boundary(header(request, "content-type"))) return std::nullopt;
  return arriving_bytes(options, request.content_length);
}

Reply added_reply(const Result<UploadResult>& added, const std::vector<GridCandidate>& candidates) {
  if (!added) return upload_refusal(added.error(), candidates);
  Reply reply = json_reply(added->is_new ? 201 : 200, added->document);
  reply.headers.emplace_back("Location", "/v1/volumes/" + added->document.at("id").get<std::string>());
  return reply;
}

Reply added_while_arriving(const Services& services, const Request& request, BodyReader& wire, std::uint64_t bytes,
                           UploadOptions options) {
  auto stated = stated_digests(request);
  if (!stated) return error_reply(stated.error());
  DigestedBody body(wire, *std::move(stated));
  std::vector<GridCandidate> candidates;
  NoProgress unwatched;
  return added_reply(import_arriving(services, body, bytes, std::move(options), unwatched, candidates), candidates);
}

Reply added_later(const Services& services, std::shared_ptr<const StagedFile> file, UploadOptions options) {
  const auto begun = import_later(services, std::move(file), std::move(options));
  if (!begun) return error_reply(begun.error());
  Reply reply = json_reply(202, *begun);
  reply.headers.emplace_back("Location", "/v1/volumes/" + begun->at("id").get<std::string>());
  reply.headers.emplace_back("Preference-Applied", "respond-async");
  return reply;
}

Reply upload(Services services, const Request& request, BodyReader& body) {
  auto options = upload_options(request.query, {"name"});
  if (!options) return error_reply(options.error());
  options->name = parameter(request, "name").value_or("");
  const auto memory = memory_to_import(services);
  if (!memory) return error_reply(memory.error());
  const bool is_async = preference(request).respond_async;
  const auto bytes = arriving(request, options->import);
  if (bytes && !is_async) return added_while_arriving(services, request, body, *bytes, *std::move(options));

  auto received = receive_file(request, body, services.store);
  if (!received) return error_reply(received.error());
  if (auto added = add_form_options(received->fields, *options); !added) return error_reply(added.error());
  if (options->name.empty()) options->name = received->name;
  if (is_async) return added_later(services, std::move(received->file), *std::move(options));
  std::vector<GridCandidate> candidates;
  NoProgress unwatched;
  return added_reply(import_spooled(services, *received->file, *options, unwatched, candidates), candidates);
}

Reply list(Services services, const Request& request) {
  if (auto known = only_parameters(request, {"page_size", "page_token"}); !known) return error_reply(known.error());
  const auto page_size = whole_parameter(request, "page_size", kDefaultPage, 1, kLargestPage);
  if (!page_size) return error_reply(page_size.error());
  const auto page =
      services.volumes.list(static_cast<std::size_t>(*page_size), parameter(request, "page_token").value_or(""));
  return page ? json_reply(200, *page) : error_reply(page.error());
}

Reply get(Services services, const Request& request) {
  const auto document = show_volume(services, request.captures[0]);
  return document ? json_reply(200, *document) : error_reply(document.error());
}

Reply change(Services services, const Request& request) {
  if (!has_json_body(request)) return not_json();
  const auto changes = parse_json(request.body);
  if (!changes) return error_reply({ErrorCode::invalid_argument, "request body: " + changes.error().message});
  const auto document = services.volumes.change(request.captures[0], *changes);
  return document ? json_reply(200, *document) : error_reply(document.error());
}

Reply remove(Services services, const Request& request) {
  if (auto removed = remove_volume(services, request.captures[0]); !removed) return error_reply(removed.error());
  Reply reply;
  reply.status = 204;
  return reply;
}

Reply histogram(Services services, const Request& request) {
  if (auto known = only_parameters(request, {"bins"}); !known) return error_reply(known.error());
  const auto bins = whole_parameter(request, "bins", kDefaultHistogramBins, 1, kMaxHistogramBins);
  if (!bins) return error_reply(bins.error());
  const auto counted = std::make_shared<Histogram>();
  auto job = begin_histogram(services, request.captures[0], static_cast<int>(*bins), counted);
  return after_job(std::move(job), WhenAbandoned::cancel, [counted] {
    return json_reply(200, {{"edges", counted->edges}, {"counts", counted->counts}, {"missing", counted->missing}});
  });
}

/// range=LOW,HIGH of the colours; the slice's own values where it is not given.
Result<ValueRange> colour_range(const Request& request, const Slice& slice) {
  ValueRange range{INFINITY, -INFINITY};
  const auto text = parameter(request, "range");
  if (!text) {
    for (const float f : slice.samples) {
      if (f < range.min) range.min = f;
      if (f > range.max) range.max = f;
    }
    return range.min <= range.max ? range : ValueRange{0, 1};
  }
  const auto ends = pair_of("range", *text);
  if (!ends) return ends.error();
  for (const auto& [end, value] : {std::pair{&ends->first, &range.min}, {&ends->second, &range.max}}) {
    const auto [stop, problem] = std::from_chars(end->data(), end->data() + end->size(), *value);
    if (problem != std::errc{} || stop != end->data() + end->size() || !std::isfinite(*value)) {
      return Error{ErrorCode::invalid_argument, "parameter range: \"" + *text + "\"; expected two numbers"};
    }
  }
  return range;
}

Reply slice_as_floats(const Slice& slice) {
  Reply reply;
  reply.headers = {{"Content-Type", "application/octet-stream"}};
  reply.body.resize(slice.samples.size() * sizeof(float));
  std::memcpy(reply.body.data(), slice.samples.data(), reply.body.size());  // little-endian, as the machines we run on
  return reply;
}

Reply slice_as_png(const Request& request, const Slice& slice) {
  const auto range = colour_range(request, slice);
  if (!range) return error_reply(range.error());
  const auto colormap = parse_colormap(parameter(request, "colormap").value_or("gray"));
  if (!colormap) return error_reply(colormap.error());
  const auto png = slice_png(slice, range->min, range->max, *colormap);
  if (!png) return error_reply(png.error());
  Reply reply;
  reply.headers = {{"Content-Type", "image/png"}};
  reply.body.assign(reinterpret_cast<const char*>(png->data()), png->size());
  return reply;
}

Reply slice(Services services, const Request& request) {
  if (auto known = only_parameters(request, {"format", "range", "colormap"}); !known) return error_reply(known.error());
  const std::string &axis_name = request.captures[1], format = parameter(request, "format").value_or("png");
  if (format != "png" && format != "f32") {
    return error_reply({ErrorCode::invalid_argument, "parameter format: \"" + format + "\"; expected png or f32"});
  }
  const SliceAxis axis = axis_name == "inline"      ? SliceAxis::inline_
                         : axis_name == "crossline" ? SliceAxis::crossline
                                                    : SliceAxis::sample;
  std::int32_t index = -1;
  const std::string& text = request.captures[2];
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), index);
  if (problem != std::errc{}) return error_reply({ErrorCode::invalid_argument, "slice index " + text + ": too large"});
  const auto read = services.volumes.slice(request.captures[0], axis, index);
  if (!read) return error_reply(read.error());
  Reply reply = format == "f32" ? slice_as_floats(*read) : slice_as_png(request, *read);
  if (reply.status != 200) return reply;
  reply.headers.emplace_back("X-Geosis-Shape", std::to_string(read->rows) + "," + std::to_string(read->columns));
  reply.headers.emplace_back("Cache-Control", "public, max-age=31536000, immutable");
  reply.headers.push_back(download_name(request.captures[0], axis_name + "-" + std::to_string(index) + "." + format));
  return reply;
}

}  // namespace

void add_volume_routes(Router& router, const ServicesOf& services) {
  const auto with = [services](auto handler) {
    return [=](const Request& request) { return handler(services(request), request); };
  };
  router.upload("/v1/volumes", [services](const Request& request, BodyReader& body) {
    return upload(services(request), request, body);
  });
  router.get("/v1/volumes", with(list));
  router.get("/v1/volumes/([^/]+)", with(get));
  router.patch("/v1/volumes/([^/]+)", with(change));
  router.remove("/v1/volumes/([^/]+)", with(remove));
  router.get("/v1/volumes/([^/]+)/histogram", with(histogram));
  router.get("/v1/volumes/([^/]+)/slices/(inline|crossline|sample)/([0-9]+)", with(slice));
}

}  // namespace geosis::server::http
