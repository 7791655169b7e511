#include "engine/simplify/bucket_queue.h"

#include <algorithm>
#include <bit>

namespace geosis {

void BucketQueue::clear() {
  entries_.clear();
  free_ = kNone;
  head_.fill(kNone);
  occupied_.fill(0);
  lowest_word_ = static_cast<std::uint32_t>(occupied_.size());
}

// The upper bits of a positive float are its exponent and first mantissa bits: already a logarithmic scale.
std::uint32_t BucketQueue::bucket_of(float cost) {
  constexpr int kMantissaBits = 5;
  constexpr std::int32_t kFirst = (127 - 44) << kMantissaBits;  // costs from 2^-44 on
  const auto scale = static_cast<std::int32_t>(std::bit_cast<std::uint32_t>(cost) >> (23 - kMantissaBits));
  return static_cast<std::uint32_t>(std::clamp<std::int32_t>(scale - kFirst, 0, kBuckets - 1));
}

void BucketQueue::push(QueuedEdge edge, float cost) {
  const std::uint32_t bucket = bucket_of(cost);
  std::uint32_t place = free_;
  if (place != kNone) {
    free_ = entries_[place].next;
    entries_[place] = {edge, head_[bucket]};
  } else {
    place = static_cast<std::uint32_t>(entries_.size());
    entries_.push_back({edge, head_[bucket]});
  }
  head_[bucket] = place;
  occupied_[bucket / 64] |= std::uint64_t{1} << (bucket % 64);
  lowest_word_ = std::min(lowest_word_, bucket / 64);
}

bool BucketQueue::pop(QueuedEdge& edge) {
  while (lowest_word_ < occupied_.size() && occupied_[lowest_word_] == 0) ++lowest_word_;
  if (lowest_word_ == occupied_.size()) return false;
  const std::uint32_t bucket =
      lowest_word_ * 64 + static_cast<std::uint32_t>(std::countr_zero(occupied_[lowest_word_]));
  const std::uint32_t place = head_[bucket];
  Entry& entry = entries_[place];
  edge = entry.edge;
  head_[bucket] = entry.next;
  if (entry.next == kNone) occupied_[lowest_word_] &= occupied_[lowest_word_] - 1;
  entry.next = free_;
  free_ = place;
  return true;
}

}  // namespace geosis
