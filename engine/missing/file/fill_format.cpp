#include "engine/missing/file/fill_format.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "engine/volume/file_header.h"

namespace geosis {
namespace {

static_assert(std::endian::native == std::endian::little, "fill files are mapped as they are");

constexpr std::array<char, 8> kMagic = {'G', 'E', 'O', 'F', 'I', 'L', 'L', 'S'};
constexpr std::string_view kKind = "fill";
constexpr std::uint64_t kPage = 4096;
constexpr std::uint8_t kMostReliable = 254;

struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint32_t version = kFillFileVersion;
  std::array<std::int32_t, 3> shape{};
  std::uint64_t volume_checksum = 0;
  std::uint64_t filled_nodes = 0;
  std::uint64_t records = 0;
  std::uint64_t file_bytes = 0;
  std::uint64_t index_checksum = 0;  // XXH3-64 of everything from the summaries to the end of the block ranges
  std::uint64_t checksum = 0;        // XXH3-64 of the header with this field zero
};
static_assert(sizeof(Header) == 72);

Error damaged(const std::string& what) {
  return damaged_file(kKind, what);
}

std::span<const std::byte> index_bytes(const FillFilePlan& plan, std::span<const std::byte> file) {
  const std::uint64_t end = plan.block_ranges_at + plan.layout.brick_count() * kFillBlockBytes;
  return file.subspan(plan.summaries_at, end - plan.summaries_at);
}

Result<Header> read_header_of(const BrickedVolume& volume, std::span<const std::byte> file) {
  auto header = read_header<Header>(kKind, file);
  if (!header) return header;
  const auto& [inlines, crosslines, samples] = header->shape;
  if (GridShape{inlines, crosslines, samples} != volume.shape() || header->volume_checksum != index_checksum(volume))
    return damaged("belongs to another volume");
  return header;
}

/// Rising places inside the brick, finite values, reliabilities of filled samples, zeros between them.
bool is_sound(std::span<const FilledSample> records, GridShape extent) {
  std::int64_t last = -1;
  bool sound = true;
  for (const FilledSample& record : records) {
    std::array<std::uint8_t, 3> padding;
    std::memcpy(padding.data(), reinterpret_cast<const std::byte*>(&record) + 9, padding.size());
    sound &= record.place > last && std::isfinite(record.value) && record.reliability <= kMostReliable &&
             (padding[0] | padding[1] | padding[2]) == 0;
    last = record.place;
  }
  return sound && last < extent.count();
}

/// Records of nodes that no later brick holds too: each filled node of the volume once.
std::uint64_t count_own(std::span<const FilledSample> records, const BrickLayout& layout, GridIndex place) {
  const GridShape extent = layout.extent(place), grid = layout.grid();
  const auto crosslines = static_cast<std::uint32_t>(extent.crosslines);
  const auto samples = static_cast<std::uint32_t>(extent.samples);
  const GridShape own{extent.inlines - (place.i + 1 < grid.inlines),
                      extent.crosslines - (place.j + 1 < grid.crosslines),
                      extent.samples - (place.k + 1 < grid.samples)};
  std::uint64_t count = 0;
  for (const FilledSample& record : records) {
    const std::uint32_t row = record.place / samples;
    count += static_cast<std::int32_t>(row / crosslines) < own.inlines &&
             static_cast<std::int32_t>(row % crosslines) < own.crosslines &&
             static_cast<std::int32_t>(record.place % samples) < own.samples;
  }
  return count;
}

/// The records of all bricks, against their summaries and the header's counts.
Result<void> check_records(const FillFilePlan& plan, std::span<const std::byte> file) {
  const auto* summaries = reinterpret_cast<const StoredFill*>(file.data() + plan.summaries_at);
  const auto* records = reinterpret_cast<const FilledSample*>(file.data() + plan.records_at);
  std::uint64_t first = 0, filled_nodes = 0;
  for (std::size_t brick = 0; brick < plan.layout.brick_count(); ++brick) {
    const StoredFill& summary = summaries[brick];
    const std::string name = "brick " + std::to_string(brick);
    if (summary.first != first || summary.count > plan.records - first)
      return damaged(name + " has its records at " + std::to_string(summary.first) + "; expected " +
                     std::to_string(first));
    const std::span<const FilledSample> own(records + first, summary.count);
    const GridIndex place = plan.layout.place(brick);
    if (checksum_of(std::as_bytes(own)) != summary.checksum) return damaged(name + " fails its checksum");
    if (!is_sound(own, plan.layout.extent(place))) return damaged(name + " has a record that cannot be");
    filled_nodes += count_own(own, plan.layout, place);
    first += summary.count;
  }
  if (first != plan.records || filled_nodes != plan.filled_nodes)
    return damaged(std::to_string(first) + " records of " + std::to_string(filled_nodes) + " nodes; its header says " +
                   std::to_string(plan.records) + " and " + std::to_string(plan.filled_nodes));
  return {};
}

}  // namespace

FillFilePlan plan_fill_file(GridShape shape, std::uint64_t records) {
  FillFilePlan plan;
  plan.layout = BrickLayout(shape);
  plan.records = records;
  const std::uint64_t bricks = plan.layout.brick_count();
  plan.summaries_at = round_up(sizeof(Header), 64);
  plan.block_ranges_at = round_up(plan.summaries_at + bricks * sizeof(StoredFill), 64);
  plan.records_at = round_up(plan.block_ranges_at + bricks * kFillBlockBytes, kPage);
  plan.file_bytes = plan.records_at + records * sizeof(FilledSample);
  return plan;
}

std::uint64_t index_checksum(const BrickedVolume& volume) {
  const GridShape shape = volume.shape();
  std::uint64_t sum = XXH3_64bits(&shape, sizeof shape);
  for (std::size_t brick = 0; brick < volume.brick_count(); ++brick) {
    struct {
      ValueRange range;
      std::uint32_t missing;
    } entry;
    const BrickSummary summary = volume.summary(brick);
    entry.range = summary.range;
    entry.missing = (summary.has_missing ? 1u : 0u) | (summary.all_missing ? 2u : 0u);
    static_assert(sizeof entry == 12);
    sum = XXH3_64bits_withSeed(&entry, sizeof entry, sum);
    const auto blocks = volume.block_ranges(brick);
    sum = XXH3_64bits_withSeed(blocks.data(), blocks.size_bytes(), sum);
  }
  return sum;
}

void write_fill_header(const FillFilePlan& plan, std::uint64_t volume_checksum, std::span<std::byte> file) {
  const GridShape shape = plan.layout.shape();
  Header header;
  header.shape = {shape.inlines, shape.crosslines, shape.samples};
  header.volume_checksum = volume_checksum;
  header.filled_nodes = plan.filled_nodes;
  header.records = plan.records;
  header.file_bytes = plan.file_bytes;
  header.index_checksum = checksum_of(index_bytes(plan, file));
  header.checksum = header_checksum(header);
  std::memcpy(file.data(), &header, sizeof header);
}

Result<FillFilePlan> read_fill_file(const BrickedVolume& volume, std::span<const std::byte> file) {
  const auto header = read_header_of(volume, file);
  if (!header) return header.error();
  if (header->records > file.size() / sizeof(FilledSample))
    return damaged(std::to_string(header->records) + " records are more than it holds");
  FillFilePlan plan = plan_fill_file(volume.shape(), header->records);
  plan.filled_nodes = header->filled_nodes;
  if (plan.file_bytes != file.size())
    return damaged(std::to_string(file.size()) + " bytes; expected " + std::to_string(plan.file_bytes));
  if (checksum_of(index_bytes(plan, file)) != header->index_checksum) return damaged("its index fails its checksum");
  if (auto checked = check_records(plan, file); !checked) return std::move(checked).error();
  return plan;
}

}  // namespace geosis
