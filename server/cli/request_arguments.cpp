#include "server/cli/request_arguments.h"

#include <array>
#include <charconv>
#include <fstream>
#include <optional>
#include <span>
#include <string_view>

#include "server/documents/ids.h"
#include "server/documents/request.h"

namespace geosis::server {
namespace {

Result<Json> read_request_file(const std::string& path) {
  constexpr std::size_t kMostBytes = 1 << 20;
  std::ifstream file(path, std::ios::binary);
  if (!file) return Error{ErrorCode::not_found, path + ": cannot be read"};
  std::string text(kMostBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (file.bad()) return Error{ErrorCode::unavailable, path + ": reading failed"};
  if (text.size() > kMostBytes) return Error{ErrorCode::limit_exceeded, path + ": a request has at most 1 MiB"};
  auto document = parse_json(text);
  if (!document) return Error{document.error().code, path + ": " + document.error().message};
  return document;
}

Error unreadable(const char* flag, const std::string& text, const char* expected) {
  return {ErrorCode::invalid_argument, std::string(flag) + " " + text + ": expected " + expected};
}

/// Whole numbers that are separated as `separators` says, one character between two.
bool read_numbers(std::string_view text, std::string_view separators, std::span<int> numbers) {
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::size_t n = 0; n < numbers.size(); ++n) {
    const auto parsed = std::from_chars(at, end, numbers[n]);
    if (parsed.ec != std::errc{}) return false;
    at = parsed.ptr;
    if (n + 1 == numbers.size()) break;
    if (at == end || *at != separators[n]) return false;
    ++at;
  }
  return at == end;
}

/// A number as JSON; what it may be is the request's to check.
Result<Json> number_from_text(const char* flag, const std::string& text) {
  const auto number = parse_json(text);
  if (number && number->is_number()) return *number;
  return unreadable(flag, text, "a number");
}

/// Writes a member of an object that the request file may have already.
Json& member(Json& document, const char* object, const char* name) {
  Json& members = document[object];
  if (!members.is_object()) members = Json::object();
  return members[name];
}

Json list_from_text(std::string_view text) {
  Json list = Json::array();
  while (!text.empty()) {
    const auto name = text.substr(0, text.find(','));
    text.remove_prefix(std::min(name.size() + 1, text.size()));
    if (!name.empty()) list.push_back(std::string(name));
  }
  return list;
}

}  // namespace

RequestArguments::RequestArguments(CLI::App& command) {
  // Two values always: an end may look like a flag (-inf).
  auto* range =
      command.add_option("--range", range_, "the body is {LOW <= amplitude <= HIGH}; -inf and inf are open ends")
          ->type_name("LOW HIGH");
  auto* request =
      command.add_option("--request", request_path_, "request as JSON; flags win over it")->type_name("FILE");
  command.add_option("--mode", mode_, "exact (default) or sampled: g = (f - LOW)(HIGH - f) on the samples")
      ->type_name("MODE");
  command.add_flag("--no-cap", no_cap_, "leave the body open where it leaves the survey");
  command.add_flag("--preview", preview_,
                   "a coarse look at every few samples, one level, without a promise of topology");
  command.add_option("--region", region_, "nodes to look at, from 0, ends included")->type_name("I0:I1,J0:J1,K0:K1");
  command.add_option("--grid", grid_, "connect samples as given (default), along reflectors (structural), or auto")
      ->type_name("GRID");
  command.add_option("--space", space_, "world (default) or index")->type_name("SPACE");
  command.add_option("--velocity", velocity_, "turns the two-way times of a time survey into depths")->type_name("M/S");
  command.add_option("--missing", missing_, "fill missing samples: none (default), linear or rbf")->type_name("METHOD");
  command.add_option("--kernel", kernel_, "of rbf: polyharmonic (default) or inverse_distance")->type_name("KERNEL");
  command.add_option("--steer", steer_, "fill along the reflectors: auto (default), on or off")->type_name("WHEN");
  command.add_option("--max-distance", max_distance_, "leave missing what is further from every sample")
      ->type_name("STEPS");
  command.add_option("--min-voxels", min_voxels_, "drop bodies of less volume")->type_name("VOXELS");
  command.add_option("--largest", largest_, "keep so many bodies, the largest")->type_name("N");
  command.add_option("--seed", seeds_, "keep the bodies that contain a node; may be given several times")
      ->type_name("I,J,K");
  command
      .add_option("--attributes", attributes_, "values at the vertices: reliability (default), body, value, agreement")
      ->type_name("LIST");
  command.add_option("--attribute-volume", attribute_volume_, "survey that the attribute value is of")
      ->type_name("FILE");
  command.callback([range, request] {
    if (range->count() > 0 || request->count() > 0) return;
    throw CLI::ValidationError("--range LOW HIGH is required, or --request FILE with a range");
  });
}

Result<Json> RequestArguments::document() const {
  Json document = Json::object();
  if (!request_path_.empty()) {
    auto file = read_request_file(request_path_);
    if (!file) return file;
    document = *std::move(file);
    if (!document.is_object()) return document;
  }
  for (const auto write : {&RequestArguments::write_shape, &RequestArguments::write_missing,
                           &RequestArguments::write_bodies, &RequestArguments::write_attributes}) {
    if (auto written = (this->*write)(document); !written) return std::move(written).error();
  }
  return document;
}

Result<void> RequestArguments::write_shape(Json& document) const {
  if (!range_.first.empty()) {
    auto range = range_from_text(range_.first, range_.second);
    if (!range) return std::move(range).error();
    document["range"] = *std::move(range);
  }
  if (!region_.empty()) {
    std::array<int, 6> ends{};
    if (!read_numbers(region_, ":,:,:", ends)) return unreadable("--region", region_, "I0:I1,J0:J1,K0:K1");
    document["region"] = {
        {"inline", {ends[0], ends[1]}}, {"crossline", {ends[2], ends[3]}}, {"sample", {ends[4], ends[5]}}};
  }
  if (!velocity_.empty()) {
    auto velocity = number_from_text("--velocity", velocity_);
    if (!velocity) return std::move(velocity).error();
    document["velocity"] = *std::move(velocity);
  }
  if (!mode_.empty()) document["mode"] = mode_;
  if (!grid_.empty()) {
    const bool is_known = grid_ == "given" || grid_ == "structural" || grid_ == "auto" || is_id(grid_);
    if (!is_known) return unreadable("--grid", grid_, "given, structural or auto");
    document["grid"] = grid_;
  }
  if (!space_.empty()) document["space"] = space_;
  if (no_cap_) document["cap"] = false;
  if (preview_) document["preview"] = true;
  return {};
}

Result<void> RequestArguments::write_missing(Json& document) const {
  if (!missing_.empty()) member(document, "missing", "method") = missing_;
  if (!kernel_.empty()) member(document, "missing", "kernel") = kernel_;
  if (!steer_.empty()) member(document, "missing", "steer") = steer_;
  if (max_distance_.empty()) return {};
  auto steps = number_from_text("--max-distance", max_distance_);
  if (!steps) return std::move(steps).error();
  member(document, "missing", "max_distance") = *std::move(steps);
  return {};
}

Result<void> RequestArguments::write_bodies(Json& document) const {
  for (const auto& [flag, name, text] :
       {std::tuple("--min-voxels", "min_voxels", &min_voxels_), std::tuple("--largest", "largest", &largest_)}) {
    if (text->empty()) continue;
    auto number = number_from_text(flag, *text);
    if (!number) return std::move(number).error();
    member(document, "bodies", name) = *std::move(number);
  }
  if (seeds_.empty()) return {};
  Json seeds = Json::array();
  for (const std::string& text : seeds_) {
    std::array<int, 3> node{};
    if (!read_numbers(text, ",,", node)) return unreadable("--seed", text, "I,J,K");
    seeds.push_back(node);
  }
  member(document, "bodies", "seeds") = std::move(seeds);
  return {};
}

/// The volume's id is not known before the file is read; a request file cannot know it either.
Result<void> RequestArguments::write_attributes(Json& document) const {
  if (!attributes_.empty()) document["attributes"] = list_from_text(attributes_);
  if (attribute_volume_.empty()) return {};
  if (attributes_.empty()) document["attributes"] = {"reliability", "value"};
  document["attribute_volume"] = attribute_volume_;
  return {};
}

}  // namespace geosis::server
