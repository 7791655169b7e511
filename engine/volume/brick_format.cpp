#include "engine/volume/brick_format.h"

#include <array>
#include <bit>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "engine/volume/file_header.h"

namespace geosis {
namespace {

static_assert(std::endian::native == std::endian::little, "brick files are mapped as they are");

constexpr std::array<char, 8> kMagic = {'G', 'E', 'O', 'B', 'R', 'I', 'C', 'K'};
constexpr std::string_view kKind = "brick";
constexpr std::uint32_t kMaxSections = 64;
constexpr std::uint64_t kPage = 4096;

struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint32_t version = kBrickFileVersion;
  std::uint32_t sections = 0;
  std::array<std::int32_t, 3> shape{};
  std::int32_t brick_samples = kBrickSamples;
  std::int32_t block_cells = kBlockCells;
  std::uint32_t reserved = 0;
  std::uint64_t file_bytes = 0;
  std::uint64_t checksum = 0;  // XXH3-64 of the header with this field zero, followed by the section table
};
static_assert(sizeof(Header) == 56);

enum class SectionKind : std::uint32_t { summaries = 1, block_ranges = 2, samples = 3 };

struct Section {
  std::uint32_t kind = 0;
  std::uint32_t reserved = 0;
  std::uint64_t offset = 0, bytes = 0;
  std::uint64_t checksum = 0;  // XXH3-64 of the section; 0 for the samples, whose bricks have their own
};
static_assert(sizeof(Section) == 32);

Error damaged(const std::string& what) {
  return damaged_file(kKind, what);
}

std::uint64_t header_checksum(Header header, std::span<const Section> sections) {
  header.checksum = 0;
  const auto table = std::as_bytes(sections);  // at least one
  std::vector<std::byte> bytes(sizeof header + table.size());
  std::memcpy(bytes.data(), &header, sizeof header);
  std::memcpy(bytes.data() + sizeof header, table.data(), table.size());
  return checksum_of(bytes);
}

Result<Header> read_bricks_header(std::span<const std::byte> file) {
  const auto read = read_unchecked_header<Header>(kKind, file);
  if (!read) return read;
  const Header& header = *read;
  if (header.brick_samples != kBrickSamples || header.block_cells != kBlockCells)
    return Error{ErrorCode::unsupported, "brick file: bricks of " + std::to_string(header.brick_samples) +
                                             " samples and blocks of " + std::to_string(header.block_cells) + " cells"};
  return header;
}

Result<std::vector<Section>> read_sections(const Header& header, std::span<const std::byte> file) {
  if (header.sections == 0 || header.sections > kMaxSections)
    return damaged(std::to_string(header.sections) + " sections");
  const std::size_t table_bytes = header.sections * sizeof(Section);
  if (file.size() - sizeof header < table_bytes) return damaged("its section table is cut short");
  std::vector<Section> sections(header.sections);
  std::memcpy(sections.data(), file.data() + sizeof header, table_bytes);
  if (header_checksum(header, sections) != header.checksum) return damaged("its header fails its checksum");
  for (const Section& s : sections)
    if (s.offset > file.size() || s.bytes > file.size() - s.offset)
      return damaged("section " + std::to_string(s.kind) + " reaches beyond the file");
  return sections;
}

// The offset of the one section of this kind, which must have the size that follows from the shape.
Result<std::uint64_t> locate(std::span<const Section> sections, SectionKind kind, std::uint64_t bytes,
                             std::span<const std::byte> file) {
  const Section* found = nullptr;
  for (const Section& s : sections)
    if (s.kind == static_cast<std::uint32_t>(kind)) found = &s;
  const std::string name = "section " + std::to_string(static_cast<std::uint32_t>(kind));
  if (!found) return damaged(name + " is absent");
  if (found->bytes != bytes)
    return damaged(name + " has " + std::to_string(found->bytes) + " bytes; expected " + std::to_string(bytes));
  if (found->offset % 8 != 0) return damaged(name + " starts at " + std::to_string(found->offset));
  if (kind != SectionKind::samples && checksum_of(file.subspan(found->offset, bytes)) != found->checksum)
    return damaged(name + " fails its checksum");
  return found->offset;
}

}  // namespace

BrickFilePlan plan_brick_file(GridShape shape) {
  BrickFilePlan plan;
  plan.layout = BrickLayout(shape);
  const std::uint64_t bricks = plan.layout.brick_count();
  plan.summaries_at = round_up(sizeof(Header) + 3 * sizeof(Section), 64);
  plan.block_ranges_at = round_up(plan.summaries_at + bricks * sizeof(StoredSummary), 64);
  plan.samples_at = round_up(plan.block_ranges_at + bricks * kBlockRangeBytes, kPage);
  plan.file_bytes = plan.samples_at + plan.layout.stored_samples() * sizeof(float);
  return plan;
}

void write_brick_header(const BrickFilePlan& plan, std::span<std::byte> file) {
  const std::uint64_t bricks = plan.layout.brick_count();
  std::array<Section, 3> sections = {Section{static_cast<std::uint32_t>(SectionKind::summaries), 0, plan.summaries_at,
                                             bricks * sizeof(StoredSummary), 0},
                                     Section{static_cast<std::uint32_t>(SectionKind::block_ranges), 0,
                                             plan.block_ranges_at, bricks * kBlockRangeBytes, 0},
                                     Section{static_cast<std::uint32_t>(SectionKind::samples), 0, plan.samples_at,
                                             plan.layout.stored_samples() * sizeof(float), 0}};
  for (Section& s : std::span(sections).first(2)) s.checksum = checksum_of(file.subspan(s.offset, s.bytes));

  const GridShape shape = plan.layout.shape();
  Header header;
  header.sections = static_cast<std::uint32_t>(sections.size());
  header.shape = {shape.inlines, shape.crosslines, shape.samples};
  header.file_bytes = plan.file_bytes;
  header.checksum = header_checksum(header, sections);
  std::memcpy(file.data(), &header, sizeof header);
  std::memcpy(file.data() + sizeof header, sections.data(), sizeof sections);
}

Result<BrickFilePlan> read_brick_header(std::span<const std::byte> file) {
  const auto header = read_bricks_header(file);
  if (!header) return header.error();
  const auto sections = read_sections(*header, file);
  if (!sections) return sections.error();

  const GridShape shape{header->shape[0], header->shape[1], header->shape[2]};
  if (const auto valid = check_axes(shape); !valid) return damaged(valid.error().message);
  BrickFilePlan plan;
  plan.layout = BrickLayout(shape);
  plan.file_bytes = file.size();
  const std::uint64_t bricks = plan.layout.brick_count();
  const auto summaries = locate(*sections, SectionKind::summaries, bricks * sizeof(StoredSummary), file);
  if (!summaries) return summaries.error();
  const auto blocks = locate(*sections, SectionKind::block_ranges, bricks * kBlockRangeBytes, file);
  if (!blocks) return blocks.error();
  const auto samples = locate(*sections, SectionKind::samples, plan.layout.stored_samples() * sizeof(float), file);
  if (!samples) return samples.error();
  plan.summaries_at = *summaries;
  plan.block_ranges_at = *blocks;
  plan.samples_at = *samples;
  return plan;
}

}  // namespace geosis
