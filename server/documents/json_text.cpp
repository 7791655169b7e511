#include "server/documents/json_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <vector>

namespace geosis::server {
namespace {

constexpr int kMaxDepth = 32;

/// Listens to the parser: what it accepts silently and we do not.
class StrictListener {
 public:
  bool operator()(int depth, Json::parse_event_t event, const Json& parsed) {
    if (depth > kMaxDepth) note("deeper than 32 levels");
    switch (event) {
      case Json::parse_event_t::object_start:
        members_.emplace_back();
        break;
      case Json::parse_event_t::object_end:
        members_.pop_back();
        break;
      case Json::parse_event_t::key: {
        const auto& name = parsed.get_ref<const std::string&>();
        if (!members_.back().insert(name).second) note("member \"" + name + "\" given twice");
        break;
      }
      case Json::parse_event_t::array_start:
      case Json::parse_event_t::array_end:
      case Json::parse_event_t::value:
        break;
    }
    return problem_.empty();
  }

  const std::string& problem() const { return problem_; }

 private:
  void note(std::string problem) {
    if (problem_.empty()) problem_ = std::move(problem);
  }

  std::vector<std::set<std::string>> members_;  // of each object that is open
  std::string problem_;
};

/// The library's message without its "[json.exception...]" mark.
std::string without_mark(const std::string& what) {
  const auto end = what.find("] ");
  return end == std::string::npos ? what : what.substr(end + 2);
}

std::string number_text(double number) {
  constexpr double kWholeLimit = 9007199254740992.0;  // 2^53: below it every whole number is a double
  char text[32];
  const bool is_whole = std::abs(number) < kWholeLimit && number == std::trunc(number);
  const auto end = is_whole ? std::to_chars(text, text + sizeof text, static_cast<long long>(number)).ptr
                            : std::to_chars(text, text + sizeof text, number).ptr;
  return {text, end};
}

void append_canonical(std::string& text, const Json& value);

void append_object(std::string& text, const Json& object) {
  std::vector<std::string> names;
  for (const auto& [name, member] : object.items()) names.push_back(name);
  std::sort(names.begin(), names.end());
  char separator = '{';
  for (const auto& name : names) {
    text += separator;
    append_canonical(text, name);
    text += ':';
    append_canonical(text, object[name]);
    separator = ',';
  }
  text += names.empty() ? "{}" : "}";
}

void append_array(std::string& text, const Json& array) {
  char separator = '[';
  for (const auto& element : array) {
    text += separator;
    append_canonical(text, element);
    separator = ',';
  }
  text += array.empty() ? "[]" : "]";
}

void append_canonical(std::string& text, const Json& value) {
  if (value.is_object()) {
    append_object(text, value);
  } else if (value.is_array()) {
    append_array(text, value);
  } else if (value.is_number_float()) {
    text += number_text(value.get<double>());
  } else {
    text += value.dump(-1, ' ', false, Json::error_handler_t::replace);
  }
}

}  // namespace

Result<Json> parse_json(std::string_view text) {
  StrictListener listener;
  try {
    Json value = Json::parse(text, std::ref(listener));
    if (!listener.problem().empty()) return Error{ErrorCode::malformed_input, "JSON: " + listener.problem()};
    return value;
  } catch (const Json::exception& failure) {
    return Error{ErrorCode::malformed_input, "JSON: " + without_mark(failure.what())};
  }
}

std::string canonical_text(const Json& value) {
  std::string text;
  append_canonical(text, value);
  return text;
}

std::string document_text(const Json& value) {
  return value.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json number_or_null(double number) {
  return std::isfinite(number) ? Json(number) : Json(nullptr);
}

}  // namespace geosis::server
