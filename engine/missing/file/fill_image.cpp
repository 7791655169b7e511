#include "engine/missing/file/fill_image.h"

#include <cassert>
#include <cstring>
#include <string>
#include <utility>

#include "engine/volume/mapped_file.h"

namespace geosis {

FillImage::FillImage(const BrickedVolume& volume, std::shared_ptr<const void> owner, std::span<const std::byte> bytes,
                     const FillFilePlan& plan)
    : volume_(volume), owner_(std::move(owner)), bytes_(bytes), plan_(plan) {}

const StoredFill& FillImage::stored(std::size_t brick) const {
  assert(brick < brick_count());
  return reinterpret_cast<const StoredFill*>(bytes_.data() + plan_.summaries_at)[brick];
}

BrickSummary FillImage::summary(std::size_t brick) const {
  const StoredFill& fill = stored(brick);
  return {fill.range, (fill.flags & kFillHasMissing) != 0, (fill.flags & kFillAllMissing) != 0};
}

std::span<const ValueRange, kBlocksPerBrick> FillImage::block_ranges(std::size_t brick) const {
  assert(brick < brick_count());
  const std::byte* first = bytes_.data() + plan_.block_ranges_at + brick * kFillBlockBytes;
  return std::span<const ValueRange, kBlocksPerBrick>(reinterpret_cast<const ValueRange*>(first), kBlocksPerBrick);
}

std::span<const FilledSample> FillImage::filled(std::size_t brick) const {
  const StoredFill& fill = stored(brick);
  return {reinterpret_cast<const FilledSample*>(bytes_.data() + plan_.records_at) + fill.first, fill.count};
}

Result<BrickView> FillImage::brick(std::size_t brick) const {
  auto view = volume_.brick(brick);
  const auto records = filled(brick);
  if (!view || records.empty()) return view;
  const auto count = static_cast<std::size_t>(view->extent.count());
  const auto samples = std::make_shared_for_overwrite<float[]>(count);
  std::memcpy(samples.get(), view->samples, count * sizeof(float));
  for (const FilledSample& record : records) {
    float& sample = samples[record.place];
    if (sample == sample)
      return Error{ErrorCode::malformed_input, "fill file: brick " + std::to_string(brick) + " fills sample " +
                                                   std::to_string(record.place) + ", which is measured"};
    sample = record.value;
  }
  view->samples = samples.get();
  view->owner = samples;
  return view;
}

Result<std::unique_ptr<FilledVolume>> open_fill_file(const BrickedVolume& volume, const std::filesystem::path& path) {
  auto file = MappedFile::open(path);
  if (!file) return std::move(file).error();
  const std::shared_ptr<const MappedFile> owner = *std::move(file);
  const auto plan = read_fill_file(volume, owner->bytes());
  if (!plan) return Error{plan.error().code, path.string() + ": " + plan.error().message};
  return std::unique_ptr<FilledVolume>(std::make_unique<FillImage>(volume, owner, owner->bytes(), *plan));
}

}  // namespace geosis
