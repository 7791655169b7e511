#include "engine/volume/formats/segy_write.h"

#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "engine/volume/brick_layout.h"
#include "engine/volume/formats/byte_reader.h"
#include "engine/volume/formats/segy_headers.h"
#include "engine/volume/formats/text_header.h"

namespace geosis {
namespace {

constexpr std::int32_t kMaxSamples = 65535;
constexpr std::int16_t kCentimetres = -100;  // coordinate scalar: divide by 100
constexpr std::int32_t kTracesBetweenChecks = 256;

/// A block of header words at their 1-based positions.
template <std::size_t size, int first_byte>
class HeaderBlock {
 public:
  template <class T>
  void set(int byte, T value) {
    store_big(bytes_.data() + (byte - first_byte), value);
  }
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::array<std::byte, size> bytes_{};
};
using BinaryHeader = HeaderBlock<400, 3201>;
using TraceHeader = HeaderBlock<kTraceHeaderBytes, 1>;

Error impossible(const std::string& what) {
  return {ErrorCode::invalid_argument, "SEG-Y cannot hold " + what};
}

Result<std::int32_t> whole_number(const std::string& what, double value, double low, double high) {
  if (!(value >= low && value <= high) || value != std::nearbyint(value))
    return impossible(what + " " + std::to_string(value));
  return static_cast<std::int32_t>(value);
}

/// The survey's numbers as the headers hold them.
struct WholeNumbers {
  std::int32_t interval_us = 0, delay_ms = 0;
  std::int32_t first_inline = 0, inline_step = 1, first_crossline = 0, crossline_step = 1;
};

Result<void> check_last(const char* what, double first, double step, std::int32_t count) {
  const auto last = whole_number(what, first + step * (count - 1), std::numeric_limits<std::int32_t>::min(),
                                 std::numeric_limits<std::int32_t>::max());
  if (!last) return last.error();
  return {};
}

Result<WholeNumbers> whole_numbers(const SegySurvey& survey) {
  constexpr double low = std::numeric_limits<std::int32_t>::min(), high = std::numeric_limits<std::int32_t>::max();
  WholeNumbers numbers;
  const std::array<std::pair<std::int32_t*, Result<std::int32_t>>, 6> words = {{
      {&numbers.interval_us,
       whole_number("a sample interval in microseconds of", std::round(survey.sample_axis.step * 1e6) / 1e3, 1, 65535)},
      {&numbers.delay_ms, whole_number("a delay in ms of", survey.sample_axis.first, -32768, 32767)},
      {&numbers.first_inline, whole_number("inline number", survey.inline_axis.first, low, high)},
      {&numbers.inline_step, whole_number("inline step", survey.inline_axis.step, low, high)},
      {&numbers.first_crossline, whole_number("crossline number", survey.crossline_axis.first, low, high)},
      {&numbers.crossline_step, whole_number("crossline step", survey.crossline_axis.step, low, high)},
  }};
  for (const auto& [word, value] : words) {
    if (!value) return value.error();
    *word = *value;
  }
  const GridShape& shape = survey.shape;
  if (auto last = check_last("inline number", survey.inline_axis.first, survey.inline_axis.step, shape.inlines); !last)
    return std::move(last).error();
  if (auto last =
          check_last("crossline number", survey.crossline_axis.first, survey.crossline_axis.step, shape.crosslines);
      !last)
    return std::move(last).error();
  return numbers;
}

BinaryHeader binary_header(const SegySurvey& survey, const WholeNumbers& numbers) {
  BinaryHeader header;
  header.set<std::int16_t>(3213, 1);  // one trace an ensemble
  header.set(3217, static_cast<std::uint16_t>(numbers.interval_us));
  header.set(3221, static_cast<std::uint16_t>(survey.shape.samples));
  header.set<std::int16_t>(3225, 5);       // IEEE float
  header.set<std::int16_t>(3227, 1);       // fold
  header.set<std::int16_t>(3229, 4);       // horizontally stacked
  header.set<std::int16_t>(3255, 1);       // metres
  header.set<std::uint16_t>(3501, 0x100);  // revision 1.0
  header.set<std::int16_t>(3503, 1);       // all traces of the same length
  return header;
}

/// The output file; removed again unless keep() was called.
class OutputFile {
 public:
  static Result<OutputFile> create(const std::filesystem::path& path) {
    OutputFile file(path, std::fopen(path.c_str(), "wbe"));
    if (!file.stream_) return file.failure("create");
    return file;
  }
  OutputFile(OutputFile&&) noexcept = default;
  OutputFile& operator=(OutputFile&&) = delete;
  ~OutputFile() {
    if (!stream_) return;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(path_, ignored)) std::filesystem::remove(path_, ignored);
  }

  Result<void> write(std::span<const std::byte> bytes) {
    if (std::fwrite(bytes.data(), 1, bytes.size(), stream_.get()) == bytes.size()) return {};
    return failure("write");
  }
  Result<void> keep() {
    if (std::fflush(stream_.get()) != 0) return failure("write");
    stream_.reset();
    return {};
  }

 private:
  struct Close {
    void operator()(std::FILE* stream) const { std::fclose(stream); }
  };
  OutputFile(std::filesystem::path path, std::FILE* stream) : path_(std::move(path)), stream_(stream) {}
  Error failure(const char* doing) const {
    const int number = errno;
    return {number == ENOSPC || number == EDQUOT || number == EFBIG ? ErrorCode::no_space : ErrorCode::unavailable,
            std::string("cannot ") + doing + " " + path_.string() + ": " + std::generic_category().message(number)};
  }

  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Close> stream_;
};

/// Builds and writes trace after trace.
class TraceWriter {
 public:
  TraceWriter(const SegySurvey& survey, const WholeNumbers& numbers, OutputFile& file)
      : survey_(survey),
        numbers_(numbers),
        file_(file),
        samples_(static_cast<std::size_t>(survey.shape.samples)),
        bytes_(samples_.size() * sizeof(float)) {}

  Result<void> write(std::int32_t i, std::int32_t j, const TraceSamples& samples) {
    const auto header = trace_header(i, j);
    if (!header) return header.error();
    samples(i, j, samples_);
    for (std::size_t k = 0; k < samples_.size(); ++k)
      store_big(bytes_.data() + k * sizeof(float), std::bit_cast<std::uint32_t>(samples_[k]));
    if (auto written = file_.write(header->bytes()); !written) return written;
    return file_.write(bytes_);
  }

 private:
  Result<TraceHeader> trace_header(std::int32_t i, std::int32_t j) {
    constexpr double low = std::numeric_limits<std::int32_t>::min(), high = std::numeric_limits<std::int32_t>::max();
    const Vec3d world = survey_.geometry.map({static_cast<double>(i), static_cast<double>(j), 0});
    const auto x = whole_number("an x in centimetres of", std::round(world.x * 100), low, high);
    if (!x) return x.error();
    const auto y = whole_number("a y in centimetres of", std::round(world.y * 100), low, high);
    if (!y) return y.error();

    TraceHeader header;
    ++traces_;
    header.set(1, traces_);
    header.set(5, traces_);
    header.set<std::int16_t>(29, 1);  // seismic data
    header.set(71, kCentimetres);
    header.set<std::int16_t>(89, 1);  // coordinates are lengths
    header.set(109, static_cast<std::int16_t>(numbers_.delay_ms));
    header.set(115, static_cast<std::uint16_t>(survey_.shape.samples));
    header.set(117, static_cast<std::uint16_t>(numbers_.interval_us));
    header.set(181, *x);
    header.set(185, *y);
    header.set(189, numbers_.first_inline + i * numbers_.inline_step);
    header.set(193, numbers_.first_crossline + j * numbers_.crossline_step);
    return header;
  }

  const SegySurvey& survey_;
  const WholeNumbers& numbers_;
  OutputFile& file_;
  std::int32_t traces_ = 0;
  std::vector<float> samples_;
  std::vector<std::byte> bytes_;
};

Result<void> write_traces(const SegySurvey& survey, const WholeNumbers& numbers, const TraceSamples& samples,
                          const TraceMask& is_live, OutputFile& file, Progress& progress) {
  TraceWriter writer(survey, numbers, file);
  for (std::int32_t i = 0; i < survey.shape.inlines; ++i) {
    for (std::int32_t j = 0; j < survey.shape.crosslines; ++j) {
      if (j % kTracesBetweenChecks == 0 && progress.cancelled()) return Error{ErrorCode::cancelled, "cancelled"};
      if (is_live && !is_live(i, j)) continue;
      if (auto written = writer.write(i, j, samples); !written) return written;
    }
    progress.report("write", static_cast<double>(i + 1) / survey.shape.inlines);
  }
  return {};
}

}  // namespace

Result<void> write_segy(const std::filesystem::path& path, const SegySurvey& survey, const TraceSamples& samples,
                        const TraceMask& is_live, Progress& progress) {
  if (auto valid = check_axes(survey.shape); !valid) return valid;
  if (survey.shape.samples > kMaxSamples) return impossible(std::to_string(survey.shape.samples) + " samples a trace");
  const auto numbers = whole_numbers(survey);
  if (!numbers) return numbers.error();
  const auto text = encode_text_header(survey.text);
  if (!text) return text.error();

  auto file = OutputFile::create(path);
  if (!file) return std::move(file).error();
  if (auto written = file->write(std::as_bytes(std::span(*text))); !written) return written;
  if (auto written = file->write(binary_header(survey, *numbers).bytes()); !written) return written;
  if (auto written = write_traces(survey, *numbers, samples, is_live, *file, progress); !written) return written;
  return file->keep();
}

}  // namespace geosis
