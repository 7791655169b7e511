#include "server/documents/slice_png.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <csetjmp>
#include <exception>
#include <span>
#include <string>

#include <png.h>

namespace geosis::server {
namespace {

constexpr int kColors = 256;
constexpr std::size_t kChannels = 4;
// The pixels take at most 257 values: whole repeated pixels compress better than differences of channels, and level 4
// takes a sixth of the time of libpng's defaults for files of about the same size.
constexpr int kCompressionLevel = 4;

struct Color {
  int red, green, blue;
};
using Pixel = std::array<png_byte, kChannels>;
using Palette = std::array<Pixel, kColors>;

constexpr Color kGray[] = {{0, 0, 0}, {255, 255, 255}};
constexpr Color kSeismic[] = {{8, 24, 104}, {48, 104, 216}, {255, 255, 255}, {216, 56, 48}, {104, 8, 16}};
// Ten samples, a ninth apart, of the viridis map of S. van der Walt and N. Smith (public domain, CC0).
constexpr Color kViridis[] = {{68, 1, 84},    {72, 40, 120},  {62, 73, 137},  {49, 104, 142}, {38, 130, 142},
                              {31, 158, 137}, {53, 183, 121}, {110, 206, 88}, {181, 222, 43}, {253, 231, 37}};

std::span<const Color> anchors_of(Colormap colormap) {
  switch (colormap) {
    case Colormap::gray:
      return kGray;
    case Colormap::seismic:
      return kSeismic;
    case Colormap::viridis:
      break;
  }
  return kViridis;
}

Palette make_palette(Colormap colormap) {
  const std::span<const Color> anchors = anchors_of(colormap);
  const int spans = static_cast<int>(anchors.size()) - 1;
  constexpr int last = kColors - 1;
  Palette palette;
  for (int c = 0; c < kColors; ++c) {
    const int left = std::min(c * spans / last, spans - 1);
    const int share = c * spans - left * last;  // of `last`, to the right anchor
    const auto mix = [&](int from, int to) {
      return static_cast<png_byte>((from * (last - share) + to * share + last / 2) / last);
    };
    const Color &a = anchors[static_cast<std::size_t>(left)], &b = anchors[static_cast<std::size_t>(left) + 1];
    palette[static_cast<std::size_t>(c)] = {mix(a.red, b.red), mix(a.green, b.green), mix(a.blue, b.blue), 255};
  }
  return palette;
}

/// Samples to pixels, row by row.
class Painter {
 public:
  Painter(float low, float high, Colormap colormap)
      : low_(low),
        high_(high),
        scale_(low < high ? (kColors - 1) / (high_ - low_) : 0),
        palette_(make_palette(colormap)) {}

  void paint(std::span<const float> samples, png_byte* pixels) const {
    static constexpr Pixel kTransparent{};
    for (const float value : samples) {
      const Pixel& pixel = value == value ? palette_[color_of(value)] : kTransparent;
      pixels = std::copy(pixel.begin(), pixel.end(), pixels);
    }
  }

 private:
  std::size_t color_of(double value) const {
    if (value < low_) return 0;
    if (value > high_) return kColors - 1;
    if (low_ == high_) return kColors / 2;
    return static_cast<std::size_t>((value - low_) * scale_ + 0.5);
  }

  double low_, high_, scale_;
  Palette palette_;
};

/// What libpng's callbacks see. libpng leaves a failed call with longjmp, past every destructor in between: this is
/// made before the jump's target and outlives it.
struct Output {
  std::vector<std::byte> bytes;
  std::vector<png_byte> row;
  std::array<char, 128> problem{};
};

void note(Output& output, const char* problem) {
  for (std::size_t c = 0; c + 1 < output.problem.size() && problem[c] != '\0'; ++c) output.problem[c] = problem[c];
}

[[noreturn]] void on_error(png_structp png, png_const_charp problem) {
  note(*static_cast<Output*>(png_get_error_ptr(png)), problem);
  png_longjmp(png, 1);
}

void on_warning(png_structp /*png*/, png_const_charp /*problem*/) {}

bool append(Output& output, std::span<const png_byte> data) {
  try {
    const auto bytes = std::as_bytes(data);
    output.bytes.insert(output.bytes.end(), bytes.begin(), bytes.end());
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

void on_data(png_structp png, png_bytep data, png_size_t size) {
  auto& output = *static_cast<Output*>(png_get_io_ptr(png));
  if (!append(output, {data, size})) png_error(png, "no memory for the image");
}

void on_flush(png_structp /*png*/) {}

/// False when libpng fails; the jump lands here, in a function without anything to destroy.
bool write_image(png_structp png, png_infop info, const Slice& slice, const Painter& painter, Output& output) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;  // NOLINT(cert-err52-cpp): libpng's only way to say so
  png_set_write_fn(png, &output, on_data, on_flush);
  png_set_IHDR(png, info, static_cast<png_uint_32>(slice.columns), static_cast<png_uint_32>(slice.rows), 8,
               PNG_COLOR_TYPE_RGB_ALPHA, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_NONE);
  png_set_compression_level(png, kCompressionLevel);
  png_write_info(png, info);
  const auto columns = static_cast<std::size_t>(slice.columns);
  for (std::int32_t r = 0; r < slice.rows; ++r) {
    painter.paint({slice.samples.data() + static_cast<std::size_t>(r) * columns, columns}, output.row.data());
    png_write_row(png, output.row.data());
  }
  png_write_end(png, nullptr);
  return true;
}

Result<void> check_image(const Slice& slice, float low, float high) {
  if (!std::isfinite(low) || !std::isfinite(high) || low > high)
    return Error{ErrorCode::invalid_argument, "colour range " + std::to_string(low) + " to " + std::to_string(high) +
                                                  "; expected finite numbers, the lower one first"};
  const std::string size = std::to_string(slice.rows) + " x " + std::to_string(slice.columns);
  const std::int64_t pixels = std::int64_t{slice.rows} * slice.columns;
  if (slice.rows < 1 || slice.columns < 1)
    return Error{ErrorCode::invalid_argument, "image of " + size + " pixels; expected at least 1 x 1"};
  if (pixels > kMaxPngPixels)
    return Error{ErrorCode::limit_exceeded,
                 "image of " + size + " pixels; the limit is " + std::to_string(kMaxPngPixels)};
  if (slice.samples.size() != static_cast<std::size_t>(pixels))
    return Error{ErrorCode::invalid_argument,
                 "slice of " + size + " has " + std::to_string(slice.samples.size()) + " samples"};
  return {};
}

}  // namespace

Result<Colormap> parse_colormap(std::string_view name) {
  if (name == "gray") return Colormap::gray;
  if (name == "seismic") return Colormap::seismic;
  if (name == "viridis") return Colormap::viridis;
  return Error{ErrorCode::invalid_argument,
               "colormap \"" + std::string(name) + "\"; expected gray, seismic or viridis"};
}

Result<std::vector<std::byte>> slice_png(const Slice& slice, float low, float high, Colormap colormap) {
  if (auto checked = check_image(slice, low, high); !checked) return std::move(checked).error();
  const Painter painter(low, high, colormap);
  Output output;
  output.row.resize(static_cast<std::size_t>(slice.columns) * kChannels);

  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &output, on_error, on_warning);
  png_infop info = png == nullptr ? nullptr : png_create_info_struct(png);
  const bool written = info != nullptr && write_image(png, info, slice, painter, output);
  png_destroy_write_struct(&png, &info);
  if (!written) {
    const std::string problem = output.problem.data();
    return Error{ErrorCode::internal, "PNG image: " + (problem.empty() ? "libpng does not start" : problem)};
  }
  return std::move(output.bytes);
}

}  // namespace geosis::server
