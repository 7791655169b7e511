#include "engine/volume/brick_image.h"

#include <cassert>
#include <string>
#include <utility>

#include <xxhash.h>

namespace geosis {

BrickImage::BrickImage(std::shared_ptr<const void> owner, std::span<const std::byte> bytes, const BrickFilePlan& plan)
    : owner_(std::move(owner)),
      bytes_(bytes),
      plan_(plan),
      states_(std::make_unique<std::atomic<State>[]>(plan.layout.brick_count())) {}

const StoredSummary& BrickImage::stored_summary(std::size_t brick) const {
  assert(brick < brick_count());
  return reinterpret_cast<const StoredSummary*>(bytes_.data() + plan_.summaries_at)[brick];
}

BrickSummary BrickImage::summary(std::size_t brick) const {
  const StoredSummary& stored = stored_summary(brick);
  return {stored.range, (stored.flags & kHasMissing) != 0, (stored.flags & kAllMissing) != 0};
}

std::span<const ValueRange, kBlocksPerBrick> BrickImage::block_ranges(std::size_t brick) const {
  assert(brick < brick_count());
  const std::byte* first = bytes_.data() + plan_.block_ranges_at + brick * kBlockRangeBytes;
  return std::span<const ValueRange, kBlocksPerBrick>(reinterpret_cast<const ValueRange*>(first), kBlocksPerBrick);
}

bool BrickImage::is_sound(std::size_t brick, std::span<const float> samples) const {
  State state = states_[brick].load(std::memory_order_relaxed);
  if (state == State::unchecked) {
    const bool matches = XXH3_64bits(samples.data(), samples.size_bytes()) == stored_summary(brick).checksum;
    state = matches ? State::sound : State::damaged;
    states_[brick].store(state, std::memory_order_relaxed);
  }
  return state == State::sound;
}

Result<BrickView> BrickImage::brick(std::size_t brick) const {
  assert(brick < brick_count());
  const GridIndex place = plan_.layout.place(brick);
  const GridShape extent = plan_.layout.extent(place);
  const auto* samples =
      reinterpret_cast<const float*>(bytes_.data() + plan_.samples_at) + plan_.layout.sample_offset(place);
  if (!is_sound(brick, {samples, static_cast<std::size_t>(extent.count())}))
    return Error{ErrorCode::malformed_input, "brick file: brick " + std::to_string(brick) + " at (" +
                                                 std::to_string(place.i) + ", " + std::to_string(place.j) + ", " +
                                                 std::to_string(place.k) + ") fails its checksum"};
  return BrickView{samples, plan_.layout.first_node(place), extent};
}

}  // namespace geosis
