#include "engine/volume/brick_writer.h"

#include <utility>

#include "engine/volume/brick_image.h"
#include "engine/volume/brick_store.h"

namespace geosis {

Result<BrickWriter> BrickWriter::create(GridShape shape, const std::optional<std::filesystem::path>& path) {
  if (auto valid = check_axes(shape); !valid) return std::move(valid).error();
  const BrickFilePlan plan = plan_brick_file(shape);
  auto file = NewFile::create(path, plan.file_bytes);
  if (!file) return std::move(file).error();
  return BrickWriter(plan, *std::move(file));
}

void BrickWriter::put(std::int32_t i, std::int32_t j, std::int32_t k0, std::span<const float> samples) {
  store_samples(file_.writable(), plan_, i, j, k0, samples);
}

Result<void> BrickWriter::write_brick(std::size_t brick, std::span<const float> samples) {
  if (auto written = write_rows(brick, 0, samples); !written) return written;
  BrickIndexer index = indexer(brick);
  index.add_rows(samples);
  set_summary(brick, index.summary());
  return {};
}

Result<void> BrickWriter::write_rows(std::size_t brick, std::int64_t first_row, std::span<const float> samples) const {
  const auto before = static_cast<std::uint64_t>(first_row * plan_.layout.extent(plan_.layout.place(brick)).samples);
  return file_.write_at(offset_of(brick) + before * sizeof(float), std::as_bytes(samples));
}

BrickIndexer BrickWriter::indexer(std::size_t brick) {
  auto* blocks = reinterpret_cast<ValueRange*>(file_.writable().data() + plan_.block_ranges_at);
  return {plan_.layout.extent(plan_.layout.place(brick)),
          std::span<ValueRange, kBlocksPerBrick>(blocks + brick * kBlocksPerBrick, kBlocksPerBrick)};
}

void BrickWriter::set_summary(std::size_t brick, const StoredSummary& summary) {
  reinterpret_cast<StoredSummary*>(file_.writable().data() + plan_.summaries_at)[brick] = summary;
  indexed_[brick] = 1;
}

std::uint64_t BrickWriter::offset_of(std::size_t brick) const {
  const BrickLayout& layout = plan_.layout;
  const std::uint64_t samples =
      brick < layout.brick_count() ? layout.sample_offset(layout.place(brick)) : layout.stored_samples();
  return plan_.samples_at + samples * sizeof(float);
}

void BrickWriter::start_writing(std::size_t first_brick, std::size_t bricks) const {
  const std::uint64_t begin = offset_of(first_brick);
  write_behind_->add(begin, offset_of(first_brick + bricks) - begin);
}

Result<std::unique_ptr<BrickedVolume>> BrickWriter::finish(int threads, Progress& progress) && {
  if (!index_file(file_.writable(), plan_, indexed_, threads, progress))
    return Error{ErrorCode::cancelled, "cancelled"};
  write_behind_.reset();
  auto published = std::move(file_).publish();
  if (!published) return std::move(published).error();
  const std::shared_ptr<const MappedFile> owner = *std::move(published);
  return std::unique_ptr<BrickedVolume>(std::make_unique<BrickImage>(owner, owner->bytes(), plan_));
}

}  // namespace geosis
