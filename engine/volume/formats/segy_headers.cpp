#include "engine/volume/formats/segy_headers.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "engine/volume/brick_layout.h"
#include "engine/volume/formats/byte_reader.h"
#include "engine/volume/formats/text_header.h"

namespace geosis {
namespace {

constexpr std::uint64_t kBinaryBytes = 400;
constexpr std::uint64_t kFileHeaderBytes = kTextBytes + kBinaryBytes;
constexpr int kFirstBinaryByte = 3201;
constexpr std::uint64_t kMaxTextBlocks = 4096;       // looked through for the end of a variable number
constexpr std::uint64_t kTextBlocksShown = 16;       // of the extended text, in the volume's description
constexpr std::int32_t kByteOrderMark = 0x01020304;  // revision 2, bytes 3297-3300

using BinaryBytes = std::array<std::byte, kBinaryBytes>;

Error malformed(const std::string& what) {
  return {ErrorCode::malformed_input, "SEG-Y: " + what};
}

std::optional<SampleCode> sample_code(int format_code) {
  switch (format_code) {
    case 1:
      return SampleCode::ibm32;
    case 2:
      return SampleCode::int32;
    case 3:
      return SampleCode::int16;
    case 5:
      return SampleCode::ieee32;
    case 6:
      return SampleCode::ieee64;
    case 7:
      return SampleCode::int24;
    case 8:
      return SampleCode::int8;
    case 9:
      return SampleCode::int64;
    case 10:
      return SampleCode::uint32;
    case 11:
      return SampleCode::uint16;
    case 12:
      return SampleCode::uint64;
    case 15:
      return SampleCode::uint24;
    case 16:
      return SampleCode::uint8;
    default:
      return std::nullopt;
  }
}

// 4 (fixed point with gain), 13 and 14 are defined or reserved, but not read.
bool is_known_format(int code) {
  return code >= 1 && code <= 16;
}

HeaderView view(const BinaryBytes& bytes, bool big_endian) {
  return {bytes, kFirstBinaryByte, big_endian};
}

// The order in which the binary header makes sense: revision 2 says it; else the sample format is 1..16 in one order
// only, because its other byte is zero.
std::optional<bool> find_big_endian(const BinaryBytes& bytes) {
  const HeaderView big = view(bytes, true), little = view(bytes, false);
  if (big.at<std::int32_t>(3297) == kByteOrderMark) return true;
  if (little.at<std::int32_t>(3297) == kByteOrderMark) return false;
  if (is_known_format(big.at<std::int16_t>(3225))) return true;
  if (is_known_format(little.at<std::int16_t>(3225))) return false;
  return std::nullopt;
}

// Major revision in byte 3501; some writers store the number 1 in the last byte of the word.
int find_revision(const BinaryBytes& bytes) {
  const auto major = std::to_integer<int>(bytes[300]), minor = std::to_integer<int>(bytes[301]);
  const int revision = major != 0 ? major : minor;
  return revision <= 2 ? revision : 0;
}

Result<BinaryBytes> read_binary_header(const ByteSource& source) {
  if (source.size() < kFileHeaderBytes)
    return malformed(std::to_string(source.size()) + " bytes, shorter than its file headers of " +
                     std::to_string(kFileHeaderBytes));
  BinaryBytes bytes;
  if (auto read = source.read_at(kTextBytes, bytes); !read) return std::move(read).error();
  return bytes;
}

Result<void> set_byte_order(SegyLayout& layout, const BinaryBytes& bytes, const ImportOptions& options) {
  const auto found = find_big_endian(bytes);
  if (options.byte_order != ByteOrder::automatic)
    layout.big_endian = options.byte_order == ByteOrder::big;
  else if (found)
    layout.big_endian = *found;
  else if (!options.sample_format)
    return malformed("no file headers: sample format " + std::to_string(view(bytes, true).at<std::int16_t>(3225)) +
                     " at byte 3225 (" + std::to_string(view(bytes, false).at<std::int16_t>(3225)) +
                     " little-endian); expected 1..16");
  return {};
}

Result<void> set_format(SegyLayout& layout, const HeaderView& header, const ImportOptions& options) {
  layout.format_code = options.sample_format.value_or(header.at<std::int16_t>(3225));
  const auto code = sample_code(layout.format_code);
  const std::string said = "sample format " + std::to_string(layout.format_code);
  if (!code && options.sample_format)
    return Error{ErrorCode::invalid_argument, "SEG-Y: " + said + " asked for; read are 1-3, 5-12, 15 and 16"};
  if (!code && !is_known_format(layout.format_code)) return malformed(said + " at byte 3225; expected 1..16");
  if (!code) return Error{ErrorCode::unsupported, "SEG-Y: " + said + " at byte 3225; read are 1-3, 5-12, 15 and 16"};
  layout.code = *code;
  return {};
}

// Samples and interval of the binary header; revision 2 has wider words for both, in use when they are not zero.
struct SampleWords {
  std::int64_t samples = 0;
  double interval_us = 0;
};
SampleWords sample_words(const HeaderView& header, int revision) {
  SampleWords words{header.at<std::uint16_t>(3221), static_cast<double>(header.at<std::int16_t>(3217))};
  // Intervals above 32767 us do not fit the signed word, and a negative one close to zero is a writer's mistake.
  if (words.interval_us < -1000) words.interval_us += 65536;
  if (revision < 2) return words;
  if (const auto samples = header.at<std::uint32_t>(3269); samples != 0) words.samples = samples;
  const auto interval = std::bit_cast<double>(header.at<std::uint64_t>(3273));
  if (std::isfinite(interval) && interval > 0) words.interval_us = interval;
  return words;
}

std::string length_unit(const HeaderView& header) {
  const auto system = header.at<std::int16_t>(3255);
  return system == 1 ? "m" : system == 2 ? "ft" : "";
}

bool ends_extended_text(const std::string& text) {
  return text.find("((SEG: EndText))") != std::string::npos || text.find("((SEG:EndText))") != std::string::npos;
}

// The number of extended text blocks when the header says -1: up to the one that announces the end.
Result<std::uint64_t> count_text_blocks(const ByteSource& source) {
  std::array<std::byte, kTextBytes> block;
  for (std::uint64_t n = 0; n < kMaxTextBlocks && kFileHeaderBytes + (n + 1) * kTextBytes <= source.size(); ++n) {
    if (auto read = source.read_at(kFileHeaderBytes + n * kTextBytes, block); !read) return std::move(read).error();
    if (ends_extended_text(decode_text_header(block))) return n + 1;
  }
  return malformed("a variable number of extended text headers (-1 at byte 3505) without ((SEG: EndText))");
}

// How a guess at the trace length and the bytes before the first trace would cut the file.
struct Fit {
  std::uint64_t traces = 0, rest = 0;
  bool whole() const { return traces > 0 && rest == 0; }
};
Fit fit(const ByteSource& source, std::uint64_t begin, std::uint64_t trailer, std::uint64_t trace_bytes) {
  if (source.size() < begin || source.size() - begin < trailer) return {};
  const std::uint64_t bytes = source.size() - begin - trailer;
  return {bytes / trace_bytes, bytes % trace_bytes};
}

Result<std::uint64_t> find_first_trace(const ByteSource& source, const HeaderView& header, SegyLayout& layout) {
  if (layout.revision >= 2) {
    const auto offset = header.at<std::uint64_t>(3521);
    if (offset >= kFileHeaderBytes && offset < source.size()) return offset;
  }
  const std::int64_t said = header.at<std::int16_t>(3505);
  std::uint64_t blocks = said > 0 ? static_cast<std::uint64_t>(said) : 0;
  if (said == -1) {
    const auto counted = count_text_blocks(source);
    if (!counted) return counted.error();
    blocks = *counted;
  }
  const std::uint64_t after_text = kFileHeaderBytes + blocks * kTextBytes;
  if (blocks == 0 || fit(source, after_text, 0, layout.trace_bytes()).whole()) return after_text;
  // Before revision 1 the word meant nothing: believe it only if the file agrees.
  if (fit(source, kFileHeaderBytes, 0, layout.trace_bytes()).whole()) {
    layout.warnings.push_back({"extended_text_count", std::to_string(said) +
                                                          " extended text headers at byte 3505, but the traces start "
                                                          "right after the binary header"});
    return kFileHeaderBytes;
  }
  return after_text;
}

// The number of samples in the first trace's own header; 0 when there is none.
Result<std::int64_t> samples_of_first_trace(const ByteSource& source, const SegyLayout& layout) {
  std::array<std::byte, kTraceHeaderBytes> bytes;
  if (source.size() < layout.first_trace + bytes.size()) return std::int64_t{0};
  if (auto read = source.read_at(layout.first_trace, bytes); !read) return std::move(read).error();
  return std::int64_t{load<std::uint16_t>(bytes.data() + 114, layout.big_endian)};
}

std::uint64_t trailer_bytes(const HeaderView& header, int revision) {
  const auto stanzas = revision >= 2 ? header.at<std::int32_t>(3529) : 0;
  return stanzas > 0 ? static_cast<std::uint64_t>(stanzas) * kTextBytes : 0;
}

Result<void> set_samples(SegyLayout& layout, std::int64_t samples) {
  if (samples > kMaxAxisNodes)
    return Error{ErrorCode::limit_exceeded, "SEG-Y: " + std::to_string(samples) + " samples a trace; the limit is " +
                                                std::to_string(kMaxAxisNodes)};
  layout.samples = static_cast<std::int32_t>(samples);
  return {};
}

Error cut_short(const SegyLayout& layout, const Fit& cut) {
  return malformed("cut short: " + std::to_string(cut.traces) + " whole traces of " +
                   std::to_string(layout.trace_bytes()) + " bytes (" + std::to_string(layout.samples) +
                   " samples) from byte " + std::to_string(layout.first_trace) + " on, then " +
                   std::to_string(cut.rest) + " bytes of another");
}

// Cuts the file into traces: the binary header's samples if the size agrees, else the first trace header's.
Result<void> set_traces(SegyLayout& layout, const ByteSource& source, const HeaderView& header) {
  const std::uint64_t trailer = trailer_bytes(header, layout.revision);
  const auto in_trace = samples_of_first_trace(source, layout);
  if (!in_trace) return in_trace.error();
  if (layout.samples == 0)
    if (auto set = set_samples(layout, *in_trace); !set) return set;
  if (layout.samples == 0) return malformed("no samples: 0 at byte 3221 and at byte 115 of the first trace header");

  Fit cut = fit(source, layout.first_trace, trailer, layout.trace_bytes());
  if (!cut.whole() && *in_trace > 0 && *in_trace != layout.samples) {
    SegyLayout other = layout;
    other.samples = static_cast<std::int32_t>(*in_trace);
    const Fit other_cut = fit(source, layout.first_trace, trailer, other.trace_bytes());
    if (other_cut.whole()) {
      layout.warnings.push_back({"sample_count", "the binary header says " + std::to_string(layout.samples) +
                                                     " samples; the trace headers and the file size say " +
                                                     std::to_string(other.samples)});
      layout.samples = other.samples;
      cut = other_cut;
    }
  }
  if (cut.traces == 0 && cut.rest == 0) return malformed("file headers only, no traces");
  if (!cut.whole()) return cut_short(layout, cut);
  layout.traces = cut.traces;
  return {};
}

Result<std::string> read_text(const ByteSource& source, std::uint64_t first_trace) {
  std::array<std::byte, kTextBytes> block;
  if (auto read = source.read_at(0, block); !read) return std::move(read).error();
  std::string text = decode_text_header(block);
  const std::uint64_t extended = std::min((first_trace - kFileHeaderBytes) / kTextBytes, kTextBlocksShown);
  for (std::uint64_t n = 0; n < extended; ++n) {
    if (auto read = source.read_at(kFileHeaderBytes + n * kTextBytes, block); !read) return std::move(read).error();
    text += "\n\n" + decode_text_header(block);
  }
  return text;
}

}  // namespace

Result<bool> looks_like_segy(const ByteSource& source) {
  if (source.size() < kFileHeaderBytes) return false;
  const auto bytes = read_binary_header(source);
  if (!bytes) return bytes.error();
  const auto big_endian = find_big_endian(*bytes);
  return big_endian && is_known_format(view(*bytes, *big_endian).at<std::int16_t>(3225));
}

Result<SegyLayout> read_segy_layout(const ByteSource& source, const ImportOptions& options) {
  const auto bytes = read_binary_header(source);
  if (!bytes) return bytes.error();
  SegyLayout layout;
  if (auto set = set_byte_order(layout, *bytes, options); !set) return std::move(set).error();
  const HeaderView header = view(*bytes, layout.big_endian);
  layout.revision = find_revision(*bytes);
  if (auto set = set_format(layout, header, options); !set) return std::move(set).error();

  const SampleWords words = sample_words(header, layout.revision);
  if (auto set = set_samples(layout, words.samples); !set) return std::move(set).error();
  layout.interval_us = words.interval_us;
  layout.length_unit = length_unit(header);
  if (layout.revision >= 2) {
    const auto extensions = header.at<std::int16_t>(3507);
    if (extensions > 0) layout.header_bytes = (1 + static_cast<std::uint64_t>(extensions)) * kTraceHeaderBytes;
  }

  const auto first_trace = find_first_trace(source, header, layout);
  if (!first_trace) return first_trace.error();
  layout.first_trace = *first_trace;
  if (auto set = set_traces(layout, source, header); !set) return std::move(set).error();
  auto text = read_text(source, layout.first_trace);
  if (!text) return std::move(text).error();
  layout.text = *std::move(text);
  return layout;
}

}  // namespace geosis
