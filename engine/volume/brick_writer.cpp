#include "engine/volume/brick_writer.h"

#include <atomic>
#include <string>
#include <system_error>
#include <utility>

#include <unistd.h>

#include "engine/volume/brick_image.h"
#include "engine/volume/brick_store.h"

namespace geosis {
namespace {

std::filesystem::path unfinished_name(const std::filesystem::path& path) {
  static std::atomic<unsigned> serial = 0;
  std::filesystem::path name = path;
  name += ".";
  name += std::to_string(::getpid());
  name += "-";
  name += std::to_string(serial++);
  name += ".part";
  return name;
}

}  // namespace

Result<BrickWriter> BrickWriter::create(GridShape shape, const std::optional<std::filesystem::path>& path) {
  if (auto valid = check_axes(shape); !valid) return std::move(valid).error();
  const BrickFilePlan plan = plan_brick_file(shape);
  const std::filesystem::path unfinished = path ? unfinished_name(*path) : std::filesystem::path();
  auto file = path ? MappedFile::create(unfinished, plan.file_bytes) : MappedFile::create_unnamed(plan.file_bytes);
  if (!file) return std::move(file).error();
  BrickWriter writer(plan, *std::move(file));
  if (path) {
    writer.path_ = *path;
    writer.unfinished_ = unfinished;
  }
  return writer;
}

BrickWriter::~BrickWriter() {
  if (!file_ || unfinished_.empty()) return;
  std::error_code ignored;
  std::filesystem::remove(unfinished_, ignored);
}

void BrickWriter::put(std::int32_t i, std::int32_t j, std::int32_t k0, std::span<const float> samples) {
  store_samples(file_->writable(), plan_, i, j, k0, samples);
}

Result<void> BrickWriter::publish() {
  if (auto synced = file_->sync(); !synced) return synced;
  std::error_code failed;
  std::filesystem::rename(unfinished_, path_, failed);
  if (failed)
    return Error{ErrorCode::unavailable, "cannot rename a file to " + path_.string() + ": " + failed.message()};
  unfinished_.clear();
  return sync_folder(path_.parent_path());
}

Result<std::unique_ptr<BrickedVolume>> BrickWriter::finish(int threads, Progress& progress) && {
  if (!index_file(file_->writable(), plan_, threads, progress)) return Error{ErrorCode::cancelled, "cancelled"};
  if (!unfinished_.empty())
    if (auto published = publish(); !published) return std::move(published).error();
  const std::shared_ptr<const MappedFile> owner = std::move(file_);
  return std::unique_ptr<BrickedVolume>(std::make_unique<BrickImage>(owner, owner->bytes(), plan_));
}

}  // namespace geosis
