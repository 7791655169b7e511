#include "server/grpc/messages/message_codec.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <google/protobuf/descriptor.h>
#include <google/protobuf/timestamp.pb.h>
#include <google/protobuf/util/time_util.h>

namespace geosis::server::rpc {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::EnumDescriptor;
using google::protobuf::EnumValueDescriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;
using google::protobuf::Timestamp;
using google::protobuf::util::TimeUtil;
using CppType = FieldDescriptor::CppType;

/// Messages that are arrays in documents.
bool is_array(const Descriptor& type) {
  static constexpr std::array<std::string_view, 7> kArrays = {
      "geosis.v1.Range", "geosis.v1.NodeInterval", "geosis.v1.Node",      "geosis.v1.Dims",
      "geosis.v1.Point", "geosis.v1.Box",          "geosis.v1.ValueRange"};
  return std::find(kArrays.begin(), kArrays.end(), type.full_name()) != kArrays.end();
}

/// The one number of a request for which null is a value of its own: no cap.
bool has_infinite_null(const FieldDescriptor& field) {
  return field.name() == "error_cap";
}

/// The same text where it is UTF-8; else with the replacement character in place of what is not.
std::string valid_text(const std::string& text) {
  const std::string quoted = Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
  return Json::parse(quoted).get<std::string>();
}

/// "running" in EXTRACTION_STATE_RUNNING: the name after the enum's own.
const EnumValueDescriptor* value_named(const EnumDescriptor& type, const std::string& name) {
  std::string ending = "_" + name;
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::toupper(c); });
  for (int n = 0; n < type.value_count(); ++n) {
    if (type.value(n)->name().ends_with(ending)) return type.value(n);
  }
  return nullptr;
}

// ---- documents to messages

void set_one(Message& message, const FieldDescriptor& field, const Json& value);

Message& new_message(Message& owner, const FieldDescriptor& field) {
  const Reflection& reflection = *owner.GetReflection();
  return field.is_repeated() ? *reflection.AddMessage(&owner, &field) : *reflection.MutableMessage(&owner, &field);
}

template <class Set, class Add, class Value>
void put(Message& message, const FieldDescriptor& field, Set set, Add add, Value value) {
  const Reflection& reflection = *message.GetReflection();
  if (field.is_repeated())
    (reflection.*add)(&message, &field, std::move(value));
  else
    (reflection.*set)(&message, &field, std::move(value));
}

void put_number(Message& message, const FieldDescriptor& field, const Json& value) {
  using R = Reflection;
  switch (field.cpp_type()) {
    case CppType::CPPTYPE_INT32:
      return put(message, field, &R::SetInt32, &R::AddInt32, value.get<std::int32_t>());
    case CppType::CPPTYPE_INT64:
      return put(message, field, &R::SetInt64, &R::AddInt64, value.get<std::int64_t>());
    case CppType::CPPTYPE_UINT32:
      return put(message, field, &R::SetUInt32, &R::AddUInt32, value.get<std::uint32_t>());
    case CppType::CPPTYPE_UINT64:
      return put(message, field, &R::SetUInt64, &R::AddUInt64, value.get<std::uint64_t>());
    case CppType::CPPTYPE_DOUBLE:
      return put(message, field, &R::SetDouble, &R::AddDouble, value.get<double>());
    default:
      return;  // the contract has no others
  }
}

void set_one(Message& message, const FieldDescriptor& field, const Json& value) {
  using R = Reflection;
  if (value.is_number()) return put_number(message, field, value);
  switch (field.cpp_type()) {
    case CppType::CPPTYPE_BOOL:
      if (value.is_boolean()) put(message, field, &R::SetBool, &R::AddBool, value.get<bool>());
      return;
    case CppType::CPPTYPE_STRING:
      if (value.is_string()) put(message, field, &R::SetString, &R::AddString, valid_text(value.get<std::string>()));
      return;
    case CppType::CPPTYPE_ENUM:
      if (const auto* named = value.is_string() ? value_named(*field.enum_type(), value.get<std::string>()) : nullptr) {
        put(message, field, &R::SetEnum, &R::AddEnum, named);
      }
      return;
    case CppType::CPPTYPE_MESSAGE:
      if (field.message_type() == Timestamp::descriptor()) {
        auto& time = static_cast<Timestamp&>(new_message(message, field));
        if (value.is_string()) TimeUtil::FromString(value.get<std::string>(), &time);
        return;
      }
      return set_message(new_message(message, field), value);
    default:
      return;
  }
}

void set_field(Message& message, const FieldDescriptor& field, const Json& value) {
  if (value.is_null()) {
    if (has_infinite_null(field)) {
      message.GetReflection()->SetDouble(&message, &field, std::numeric_limits<double>::infinity());
    }
    return;
  }
  if (!field.is_repeated()) return set_one(message, field, value);
  for (const Json& element : value) set_one(message, field, element);
}

// ---- messages to documents

/// Where in the request a walk is, and what it has found wrong first.
struct Walk {
  std::optional<Error> problem;

  void note(const std::string& pointer, const std::string& what) {
    if (!problem) problem = Error{ErrorCode::invalid_argument, "request " + pointer + ": " + what};
  }
};

Json document_at(const Message& message, const std::string& pointer, Walk& walk);

Json number_at(double number, const FieldDescriptor& field, const std::string& pointer, Walk& walk) {
  if (std::isnan(number)) walk.note(pointer, "NaN; expected a number");
  return has_infinite_null(field) && std::isinf(number) ? Json(nullptr) : Json(number);
}

Json enum_at(int number, const FieldDescriptor& field, const std::string& pointer, Walk& walk) {
  const EnumValueDescriptor* const value = field.enum_type()->FindValueByNumber(number);
  if (value == nullptr) walk.note(pointer, std::to_string(number) + " has no name here");
  std::string name = value == nullptr ? "" : value->name();
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  return name.substr(name.rfind('_') + 1);
}

/// The field's value, or that of element n of a repeated one.
Json value_at(const Message& message, const FieldDescriptor& field, int n, const std::string& pointer, Walk& walk) {
  const Reflection& get = *message.GetReflection();
  const bool many = field.is_repeated();
  switch (field.cpp_type()) {
    case CppType::CPPTYPE_INT32:
      return many ? get.GetRepeatedInt32(message, &field, n) : get.GetInt32(message, &field);
    case CppType::CPPTYPE_INT64:
      return many ? get.GetRepeatedInt64(message, &field, n) : get.GetInt64(message, &field);
    case CppType::CPPTYPE_UINT32:
      return many ? get.GetRepeatedUInt32(message, &field, n) : get.GetUInt32(message, &field);
    case CppType::CPPTYPE_UINT64:
      return many ? get.GetRepeatedUInt64(message, &field, n) : get.GetUInt64(message, &field);
    case CppType::CPPTYPE_DOUBLE:
      return number_at(many ? get.GetRepeatedDouble(message, &field, n) : get.GetDouble(message, &field), field,
                       pointer, walk);
    case CppType::CPPTYPE_BOOL:
      return many ? get.GetRepeatedBool(message, &field, n) : get.GetBool(message, &field);
    case CppType::CPPTYPE_STRING:
      return many ? get.GetRepeatedString(message, &field, n) : get.GetString(message, &field);
    case CppType::CPPTYPE_ENUM:
      return enum_at(many ? get.GetRepeatedEnumValue(message, &field, n) : get.GetEnumValue(message, &field), field,
                     pointer, walk);
    case CppType::CPPTYPE_MESSAGE:
      return document_at(many ? get.GetRepeatedMessage(message, &field, n) : get.GetMessage(message, &field), pointer,
                         walk);
    default:
      return nullptr;
  }
}

Json list_at(const Message& message, const FieldDescriptor& field, const std::string& pointer, Walk& walk) {
  Json list = Json::array();
  for (int n = 0; n < message.GetReflection()->FieldSize(message, &field); ++n) {
    list.push_back(value_at(message, field, n, pointer + "/" + std::to_string(n), walk));
  }
  return list;
}

/// An element for each field: those that can be unset and are so are null.
Json array_at(const Message& message, const std::string& pointer, Walk& walk) {
  Json array = Json::array();
  const Descriptor& type = *message.GetDescriptor();
  for (int n = 0; n < type.field_count(); ++n) {
    const FieldDescriptor& field = *type.field(n);
    const bool is_unset = field.has_presence() && !message.GetReflection()->HasField(message, &field);
    array.push_back(is_unset ? Json(nullptr) : value_at(message, field, 0, pointer + "/" + std::to_string(n), walk));
  }
  return array;
}

Json document_at(const Message& message, const std::string& pointer, Walk& walk) {
  const Reflection& reflection = *message.GetReflection();
  const auto& unknown = reflection.GetUnknownFields(message);
  if (!unknown.empty()) {
    walk.note(pointer.empty() ? "/" : pointer,
              "field " + std::to_string(unknown.field(0).number()) + " is not known to this version");
  }
  if (is_array(*message.GetDescriptor())) return array_at(message, pointer, walk);
  Json document = Json::object();
  std::vector<const FieldDescriptor*> fields;
  reflection.ListFields(message, &fields);  // those that are set
  for (const FieldDescriptor* field : fields) {
    const std::string place = pointer + "/" + field->name();
    document[field->name()] =
        field->is_repeated() ? list_at(message, *field, place, walk) : value_at(message, *field, 0, place, walk);
  }
  return document;
}

}  // namespace

void set_message(Message& message, const Json& document) {
  const Descriptor& type = *message.GetDescriptor();
  if (document.is_array() && is_array(type)) {
    const int count = std::min(type.field_count(), static_cast<int>(document.size()));
    for (int n = 0; n < count; ++n) set_field(message, *type.field(n), document[static_cast<std::size_t>(n)]);
    return;
  }
  if (!document.is_object()) return;
  for (const auto& [name, value] : document.items()) {
    if (const FieldDescriptor* field = type.FindFieldByName(name)) set_field(message, *field, value);
  }
}

Result<Json> document_of(const Message& message) {
  Walk walk;
  Json document = document_at(message, "", walk);
  if (walk.problem) return *std::move(walk.problem);
  return document;
}

std::string shortened(std::string text, std::size_t most) {
  if (text.size() <= most) return text;
  constexpr std::string_view kMore = " ...";
  std::size_t end = most - kMore.size();
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  text.resize(end);
  text += kMore;
  return text;
}

}  // namespace geosis::server::rpc
