#include "engine/structure/grid_file.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "engine/volume/brick_layout.h"
#include "engine/volume/file_header.h"
#include "engine/volume/mapped_file.h"
#include "engine/volume/new_file.h"

namespace geosis {
namespace {

static_assert(std::endian::native == std::endian::little, "grid files are copied as they are");

constexpr std::array<char, 8> kMagic = {'G', 'E', 'O', 'L', 'A', 'Y', 'E', 'R'};
constexpr std::string_view kKind = "grid";
constexpr std::uint32_t kVersion = 1;
constexpr std::int32_t kWarped = 1;

struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint32_t version = kVersion;
  std::array<std::int32_t, 3> shape{};
  std::int32_t layers = 0;
  std::int32_t flags = 0;
  std::array<double, 9> report{};  // period; median, p95, p99 of both axes; unreliable and untied share
  std::uint64_t file_bytes = 0;
  std::uint64_t body_checksum = 0;  // XXH3-64 of all that follows the header
  std::uint64_t checksum = 0;       // XXH3-64 of the header with this field zero
};
static_assert(sizeof(Header) == 128);

Error damaged(const std::string& what) {
  return damaged_file(kKind, what);
}

std::size_t agreements_of(GridShape shape) {
  return static_cast<std::size_t>(shape.inlines) * static_cast<std::size_t>(shape.crosslines) *
         static_cast<std::size_t>((shape.samples - 1) / StructuralGrid::kAgreementSpacing + 1);
}

std::array<double, 9> packed(const StructureReport& report) {
  const auto& [i, j] = report.dips.dips;
  return {report.dips.period,      i.median,           i.p95, i.p99, j.median, j.p95, j.p99,
          report.unreliable_share, report.untied_share};
}

StructureReport unpacked(const std::array<double, 9>& numbers, bool warped) {
  return {.dips = {.period = numbers[0],
                   .dips = {DipQuantiles{numbers[1], numbers[2], numbers[3]},
                            DipQuantiles{numbers[4], numbers[5], numbers[6]}},
                   .warped = warped},
          .unreliable_share = numbers[7],
          .untied_share = numbers[8]};
}

Result<Header> read_header_of(GridShape shape, std::span<const std::byte> file) {
  const auto read = read_header<Header>(kKind, file);
  if (!read) return read;
  const Header& header = *read;
  if (GridShape{header.shape[0], header.shape[1], header.shape[2]} != shape)
    return damaged("belongs to another volume");
  if (header.layers < shape.samples || header.layers > kMaxAxisNodes) {
    return damaged(std::to_string(header.layers) + " layers of " + std::to_string(shape.samples) + " samples");
  }
  for (const double number : header.report) {
    if (!std::isfinite(number)) return damaged("its report has a number that is none");
  }
  return header;
}

}  // namespace

Result<void> write_grid_file(const StructuralGrid& grid, const std::filesystem::path& path) {
  const std::span<const std::byte> words = std::as_bytes(grid.paths.words());
  const std::span<const std::byte> agreement = std::as_bytes(std::span(grid.agreement));
  auto made = NewFile::create(path, sizeof(Header) + words.size() + agreement.size());
  if (!made) return std::move(made).error();
  const std::span<std::byte> file = made->writable();
  std::memcpy(file.data() + sizeof(Header), words.data(), words.size());
  std::memcpy(file.data() + sizeof(Header) + words.size(), agreement.data(), agreement.size());
  const GridShape shape = grid.paths.shape();
  Header header;
  header.shape = {shape.inlines, shape.crosslines, shape.samples};
  header.layers = grid.paths.layers();
  header.flags = grid.report.dips.warped ? kWarped : 0;
  header.report = packed(grid.report);
  header.file_bytes = file.size();
  header.body_checksum = XXH3_64bits(file.data() + sizeof(Header), file.size() - sizeof(Header));
  header.checksum = header_checksum(header);
  std::memcpy(file.data(), &header, sizeof header);
  auto published = std::move(*made).publish();
  if (!published) return std::move(published).error();
  return {};
}

Result<StructuralGrid> read_grid_file(GridShape shape, std::span<const std::byte> file) {
  const auto header = read_header_of(shape, file);
  if (!header) return header.error();
  const std::size_t words = LayerPaths::word_count(shape, header->layers), agreements = agreements_of(shape);
  const std::span<const std::byte> body = file.subspan(sizeof(Header));
  if (body.size() != words * sizeof(std::uint64_t) + agreements) {
    return damaged(std::to_string(body.size()) + " bytes behind its header; expected " +
                   std::to_string(words * sizeof(std::uint64_t) + agreements));
  }
  if (XXH3_64bits(body.data(), body.size()) != header->body_checksum) return damaged("it fails its checksum");
  std::vector<std::uint64_t> bits(words);
  std::memcpy(bits.data(), body.data(), words * sizeof(std::uint64_t));
  StructuralGrid grid;
  grid.paths = LayerPaths(shape, header->layers, std::move(bits));
  if (!grid.paths.is_sound()) return damaged("a trace has a path that cannot be");
  grid.agreement.resize(agreements);
  std::memcpy(grid.agreement.data(), body.data() + words * sizeof(std::uint64_t), agreements);
  grid.report = unpacked(header->report, (header->flags & kWarped) != 0);
  return grid;
}

Result<StructuralGrid> open_grid_file(GridShape shape, const std::filesystem::path& path) {
  const auto file = MappedFile::open(path);
  if (!file) return file.error();
  return read_grid_file(shape, (*file)->bytes());
}

}  // namespace geosis
