#include "server/documents/object_reader.h"

#include <cmath>
#include <utility>

namespace geosis::server {
namespace {

/// The value as a message shows it: never longer than a line.
std::string shown(const Json& value) {
  constexpr std::size_t kLongest = 60;
  std::string text = canonical_text(value);
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
  return text;
}

/// RFC 6901: "~" and "/" of a name are written "~0" and "~1".
std::string escaped(const std::string& name) {
  std::string text;
  for (const char c : name) text += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return text;
}

}  // namespace

ObjectReader::ObjectReader(const Json& value, std::string pointer, std::optional<Error>& problem)
    : value_(value), pointer_(std::move(pointer)), problem_(problem) {
  if (!value_.is_object()) refuse(pointer_, value_, "an object");
}

const Json* ObjectReader::find(const char* name) {
  known_.insert(name);
  if (!value_.is_object()) return nullptr;
  const auto member = value_.find(name);
  return member == value_.end() ? nullptr : &*member;
}

bool ObjectReader::boolean(const char* name, bool otherwise) {
  const Json* member = find(name);
  if (!member) return otherwise;
  if (!member->is_boolean()) {
    refuse(pointer_to(name), *member, "true or false");
    return otherwise;
  }
  return member->get<bool>();
}

std::optional<std::int64_t> ObjectReader::whole_number(const char* name, std::int64_t min, std::int64_t max) {
  const Json* member = find(name);
  if (!member || member->is_null()) return std::nullopt;
  const auto number = whole_number_of(*member, min, max);
  if (!number) {
    refuse(pointer_to(name), *member,
           "a whole number in [" + std::to_string(min) + ", " + std::to_string(max) + "] or null");
  }
  return number;
}

int ObjectReader::choice(const char* name, std::initializer_list<const char*> choices) {
  const Json* member = find(name);
  if (!member) return 0;
  std::string expected;
  int position = 0;
  for (const char* text : choices) {
    if (*member == text) return position;
    expected += (position++ ? " or \"" : "\"") + std::string(text) + "\"";
  }
  refuse(pointer_to(name), *member, expected);
  return 0;
}

void ObjectReader::refuse_unknown() {
  if (!value_.is_object()) return;
  for (const auto& [name, member] : value_.items()) {
    if (!known_.contains(name)) {
      note(ErrorCode::invalid_argument, pointer_ + "/" + escaped(name) + ": there is no such field");
    }
  }
}

void ObjectReader::refuse(const std::string& pointer, const Json& value, const std::string& expected) {
  note(ErrorCode::invalid_argument, pointer + ": " + shown(value) + "; expected " + expected);
}

void ObjectReader::note(ErrorCode code, std::string message) {
  if (!problem_) problem_ = Error{code, "request " + std::move(message)};
}

std::optional<std::int64_t> whole_number_of(const Json& value, std::int64_t min, std::int64_t max) {
  if (!value.is_number()) return std::nullopt;
  const double number = value.get<double>();
  if (number != std::trunc(number) || number < static_cast<double>(min) || number > static_cast<double>(max)) {
    return std::nullopt;
  }
  return static_cast<std::int64_t>(number);
}

}  // namespace geosis::server
