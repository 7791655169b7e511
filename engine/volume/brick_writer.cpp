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

void BrickWriter::put_in_layer(std::int32_t bk, std::int32_t i, std::int32_t j, std::int32_t k0,
                               std::span<const float> samples) {
  store_samples_in_layer(file_.writable(), plan_, bk, i, j, k0, samples);
}

void BrickWriter::complete(std::size_t brick) {
  index_stored_brick(file_.writable(), plan_, brick);
  completed_[brick] = 1;
}

void BrickWriter::start_writing(std::size_t first_brick, std::size_t bricks) const {
  const auto offset_of = [&](std::size_t brick) {
    const std::uint64_t samples = brick < plan_.layout.brick_count()
                                      ? plan_.layout.sample_offset(plan_.layout.place(brick))
                                      : plan_.layout.stored_samples();
    return plan_.samples_at + samples * sizeof(float);
  };
  const std::uint64_t begin = offset_of(first_brick);
  file_.start_writing(begin, offset_of(first_brick + bricks) - begin);
}

Result<std::unique_ptr<BrickedVolume>> BrickWriter::finish(int threads, Progress& progress) && {
  if (!index_file(file_.writable(), plan_, completed_, threads, progress))
    return Error{ErrorCode::cancelled, "cancelled"};
  auto published = std::move(file_).publish();
  if (!published) return std::move(published).error();
  const std::shared_ptr<const MappedFile> owner = *std::move(published);
  return std::unique_ptr<BrickedVolume>(std::make_unique<BrickImage>(owner, owner->bytes(), plan_));
}

}  // namespace geosis
