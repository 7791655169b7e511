#include "engine/volume/brick_file.h"

#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/volume/brick_image.h"
#include "engine/volume/brick_store.h"
#include "engine/volume/mapped_file.h"

namespace geosis {
namespace {

void store_trace(std::span<std::byte> file, const BrickFilePlan& plan, std::int32_t i, std::int32_t j,
                 std::span<const float> samples) {
  std::vector<float> trace(samples.begin(), samples.end());
  for (float& value : trace)
    if (std::isinf(value)) value = std::numeric_limits<float>::quiet_NaN();
  store_samples(file, plan, i, j, 0, trace);
}

}  // namespace

std::unique_ptr<BrickedVolume> make_bricked_volume(GridShape shape, std::span<const float> samples) {
  assert(check_axes(shape) && static_cast<std::int64_t>(samples.size()) == shape.count());
  const BrickFilePlan plan = plan_brick_file(shape);
  auto image = std::make_shared<std::vector<std::byte>>(plan.file_bytes);
  const auto length = static_cast<std::size_t>(shape.samples);
  std::size_t trace = 0;
  for (std::int32_t i = 0; i < shape.inlines; ++i)
    for (std::int32_t j = 0; j < shape.crosslines; ++j, ++trace)
      store_trace(*image, plan, i, j, samples.subspan(trace * length, length));
  NoProgress unwatched;
  index_file(*image, plan, {}, 1, unwatched);
  return std::make_unique<BrickImage>(image, std::span<const std::byte>(*image), plan);
}

Result<std::unique_ptr<BrickedVolume>> open_brick_file(const std::filesystem::path& path) {
  auto file = MappedFile::open(path);
  if (!file) return std::move(file).error();
  const std::shared_ptr<const MappedFile> owner = *std::move(file);
  const auto plan = read_brick_header(owner->bytes());
  if (!plan) return Error{plan.error().code, path.string() + ": " + plan.error().message};
  return std::unique_ptr<BrickedVolume>(std::make_unique<BrickImage>(owner, owner->bytes(), *plan));
}

}  // namespace geosis
