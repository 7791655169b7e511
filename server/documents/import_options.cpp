#include "server/documents/import_options.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace geosis::server {
namespace {

template <class Enum, std::size_t N>
using Names = std::array<std::pair<const char*, Enum>, N>;

constexpr Names<FileFormat, 3> kFormats = {
    {{"auto", FileFormat::automatic}, {"segy", FileFormat::segy}, {"raw", FileFormat::raw}}};
constexpr Names<ByteOrder, 3> kByteOrders = {
    {{"auto", ByteOrder::automatic}, {"little", ByteOrder::little}, {"big", ByteOrder::big}}};
constexpr Names<SampleType, 8> kSampleTypes = {{{"float32", SampleType::float32},
                                                {"float64", SampleType::float64},
                                                {"int8", SampleType::int8},
                                                {"uint8", SampleType::uint8},
                                                {"int16", SampleType::int16},
                                                {"uint16", SampleType::uint16},
                                                {"int32", SampleType::int32},
                                                {"uint32", SampleType::uint32}}};
constexpr Names<RawOrder, 2> kRawOrders = {
    {{"sample", RawOrder::sample_fastest}, {"inline", RawOrder::inline_fastest}}};
constexpr Names<DuplicateTraces, 4> kDuplicates = {{{"reject", DuplicateTraces::reject},
                                                    {"first", DuplicateTraces::first},
                                                    {"last", DuplicateTraces::last},
                                                    {"mean", DuplicateTraces::mean}}};
constexpr Names<ZeroTraces, 2> kZeroTraces = {{{"keep", ZeroTraces::keep}, {"missing", ZeroTraces::missing}}};

template <class Enum, std::size_t N>
const char* name_in(const Names<Enum, N>& names, Enum value) {
  for (const auto& [name, named] : names) {
    if (named == value) return name;
  }
  return names[0].first;
}

// Setters: true when the text was taken.

template <class Enum, std::size_t N>
bool set_choice(Enum& option, const Names<Enum, N>& names, std::string_view text) {
  for (const auto& [name, value] : names) {
    if (text == name) {
      option = value;
      return true;
    }
  }
  return false;
}

template <class T>
std::optional<T> parse_number(std::string_view text) {
  T number{};
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (problem != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

bool set_number(std::optional<double>& option, std::string_view text) {
  const auto number = parse_number<double>(text);
  if (!number || !std::isfinite(*number)) return false;
  option = number;
  return true;
}

template <class Option>
bool set_whole(Option& option, int min, int max, std::string_view text) {
  const auto number = parse_number<int>(text);
  if (!number || *number < min || *number > max) return false;
  option = *number;
  return true;
}

bool set_byte(std::optional<int>& option, std::string_view text) {
  constexpr int kTraceHeaderBytes = 240;
  return set_whole(option, 1, kTraceHeaderBytes, text);
}

bool set_width(int& option, std::string_view text) {
  int width = 0;
  if (!set_whole(width, 2, 4, text) || width == 3) return false;
  option = width;
  return true;
}

/// Three numbers parted by commas.
template <class T>
std::optional<std::array<T, 3>> parse_triple(std::string_view text) {
  std::array<T, 3> triple{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto comma = axis < 2 ? text.find(',') : text.size();
    if (comma == std::string_view::npos) return std::nullopt;
    const auto number = parse_number<T>(text.substr(0, comma));
    if (!number) return std::nullopt;
    triple[axis] = *number;
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return triple;
}

bool set_vector(Vec3d& option, std::string_view text) {
  const auto triple = parse_triple<double>(text);
  if (!triple) return false;
  for (const double number : *triple) {
    if (!std::isfinite(number)) return false;
  }
  option = {(*triple)[0], (*triple)[1], (*triple)[2]};
  return true;
}

bool set_dims(std::optional<GridShape>& option, std::string_view text) {
  const auto triple = parse_triple<std::int32_t>(text);
  if (!triple) return false;
  for (const std::int32_t count : *triple) {
    if (count < 1) return false;
  }
  option = GridShape{(*triple)[0], (*triple)[1], (*triple)[2]};
  return true;
}

struct Setter {
  ImportOptionName option;
  bool (*set)(ImportOptions&, std::string_view);
};

const std::array kSetters = {
    Setter{{"format", "auto|segy|raw", "file format"},
           [](ImportOptions& o, std::string_view text) { return set_choice(o.format, kFormats, text); }},
    Setter{{"byte_order", "auto|little|big", "byte order"},
           [](ImportOptions& o, std::string_view text) { return set_choice(o.byte_order, kByteOrders, text); }},
    Setter{{"null_value", "NUMBER", "samples of this value are missing"},
           [](ImportOptions& o, std::string_view text) { return set_number(o.null_value, text); }},
    Setter{{"dims", "I,J,K", "raw: number of inlines, crosslines, samples"},
           [](ImportOptions& o, std::string_view text) { return set_dims(o.dims, text); }},
    Setter{{"dtype", "float32|float64|int8|uint8|int16|uint16|int32|uint32", "raw: sample type"},
           [](ImportOptions& o, std::string_view text) { return set_choice(o.dtype, kSampleTypes, text); }},
    Setter{{"order", "sample|inline", "raw: the index that runs fastest"},
           [](ImportOptions& o, std::string_view text) { return set_choice(o.order, kRawOrders, text); }},
    Setter{{"origin", "X,Y,Z", "raw: world position of the first node"},
           [](ImportOptions& o, std::string_view text) { return set_vector(o.origin, text); }},
    Setter{{"spacing", "DI,DJ,DK", "raw: world distance of neighbouring nodes"},
           [](ImportOptions& o, std::string_view text) { return set_vector(o.spacing, text); }},
    Setter{{"inline_byte", "BYTE", "segy: trace header byte of the inline number, counted from 1"},
           [](ImportOptions& o, std::string_view text) { return set_byte(o.inline_byte, text); }},
    Setter{{"crossline_byte", "BYTE", "segy: trace header byte of the crossline number"},
           [](ImportOptions& o, std::string_view text) { return set_byte(o.crossline_byte, text); }},
    Setter{{"inline_width", "2|4", "segy: bytes of the inline number"},
           [](ImportOptions& o, std::string_view text) { return set_width(o.inline_width, text); }},
    Setter{{"crossline_width", "2|4", "segy: bytes of the crossline number"},
           [](ImportOptions& o, std::string_view text) { return set_width(o.crossline_width, text); }},
    Setter{{"x_byte", "BYTE", "segy: trace header byte of the x coordinate"},
           [](ImportOptions& o, std::string_view text) { return set_byte(o.x_byte, text); }},
    Setter{{"y_byte", "BYTE", "segy: trace header byte of the y coordinate"},
           [](ImportOptions& o, std::string_view text) { return set_byte(o.y_byte, text); }},
    Setter{{"coordinate_scalar", "NUMBER", "segy: replaces the scalar of the trace headers"},
           [](ImportOptions& o, std::string_view text) { return set_number(o.coordinate_scalar, text); }},
    Setter{{"sample_format", "CODE", "segy: replaces the format code of the binary header"},
           [](ImportOptions& o, std::string_view text) { return set_whole(o.sample_format, 1, 16, text); }},
    Setter{{"duplicates", "reject|first|last|mean", "segy: what to do with traces of the same place"},
           [](ImportOptions& o, std::string_view text) { return set_choice(o.duplicates, kDuplicates, text); }},
    Setter{{"zero_traces", "keep|missing", "segy: what traces of zeros alone are"},
           [](ImportOptions& o, std::string_view text) { return set_choice(o.zero_traces, kZeroTraces, text); }},
};

/// A JSON value as the text that set_import_option takes: arrays as comma-separated elements.
std::string option_text(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_array()) return value.dump();
  std::string text;
  for (const Json& element : value) {
    if (!text.empty()) text += ',';
    text += element.dump();
  }
  return text;
}

template <class T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

void add_raw_options(Json& document, const ImportOptions& options) {
  document["dims"] = nullptr;
  if (options.dims) document["dims"] = {options.dims->inlines, options.dims->crosslines, options.dims->samples};
  document["dtype"] = name_in(kSampleTypes, options.dtype);
  document["order"] = name_in(kRawOrders, options.order);
  document["origin"] = {options.origin.x, options.origin.y, options.origin.z};
  document["spacing"] = {options.spacing.x, options.spacing.y, options.spacing.z};
}

void add_segy_options(Json& document, const ImportOptions& options) {
  document["inline_byte"] = or_null(options.inline_byte);
  document["crossline_byte"] = or_null(options.crossline_byte);
  document["inline_width"] = options.inline_width;
  document["crossline_width"] = options.crossline_width;
  document["x_byte"] = or_null(options.x_byte);
  document["y_byte"] = or_null(options.y_byte);
  document["coordinate_scalar"] = or_null(options.coordinate_scalar);
  document["sample_format"] = or_null(options.sample_format);
  document["duplicates"] = name_in(kDuplicates, options.duplicates);
  document["zero_traces"] = name_in(kZeroTraces, options.zero_traces);
}

}  // namespace

std::span<const ImportOptionName> import_option_names() {
  static const auto names = [] {
    std::vector<ImportOptionName> list;
    for (const auto& setter : kSetters) list.push_back(setter.option);
    return list;
  }();
  return names;
}

Result<void> set_import_option(ImportOptions& options, std::string_view name, std::string_view text) {
  for (const auto& setter : kSetters) {
    if (name != setter.option.name) continue;
    if (setter.set(options, text)) return {};
    return Error{ErrorCode::invalid_argument, "import option " + std::string(name) + ": \"" + std::string(text) +
                                                  "\"; expected " + setter.option.value};
  }
  return Error{ErrorCode::invalid_argument, "import option " + std::string(name) + ": there is no such option"};
}

Result<void> set_import_options(ImportOptions& options, const Json& document) {
  for (const auto& [name, value] : document.items()) {
    if (value.is_null()) continue;
    if (auto set = set_import_option(options, name, option_text(value)); !set) return set;
  }
  return {};
}

Json import_options_document(const ImportOptions& options) {
  Json document = {{"format", name_in(kFormats, options.format)},
                   {"byte_order", name_in(kByteOrders, options.byte_order)},
                   {"null_value", or_null(options.null_value)}};
  if (options.format != FileFormat::segy) add_raw_options(document, options);
  if (options.format != FileFormat::raw) add_segy_options(document, options);
  return document;
}

}  // namespace geosis::server
