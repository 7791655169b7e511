#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace geosis {

/// An edge of a window and the versions its ends had when its cost was computed.
struct QueuedEdge {
  std::uint16_t u = 0, v = 0;
  std::uint16_t version_u = 0, version_v = 0;
};

/// Edges by cost, cheapest first, to within 3 %: 32 buckets an octave over 64 octaves. What is cheaper or dearer than
/// that lands in the first or the last bucket. Within a bucket, last in, first out.
class BucketQueue {
 public:
  BucketQueue() { clear(); }

  void clear() {
    used_ = 0;
    free_ = kNone;
    head_.fill(kNone);
    occupied_.fill(0);
    lowest_word_ = static_cast<std::uint32_t>(occupied_.size());
  }

  /// Makes room for that many edges; pushing more makes room by itself.
  void reserve(std::size_t edges) {
    if (entries_.size() < edges) entries_.resize(edges);
  }

  void push(QueuedEdge edge, float cost) {
    const std::uint32_t bucket = bucket_of(cost);
    std::uint32_t place = free_;
    if (place != kNone) {
      free_ = entries_[place].next;
    } else {
      place = used_++;
      if (place == entries_.size()) make_room();
    }
    entries_[place] = {edge, head_[bucket]};
    head_[bucket] = place;
    occupied_[bucket / 64] |= std::uint64_t{1} << (bucket % 64);
    lowest_word_ = std::min(lowest_word_, bucket / 64);
  }

  /// Takes a cheapest edge; false when there is none.
  bool pop(QueuedEdge& edge) {
    while (lowest_word_ < occupied_.size() && occupied_[lowest_word_] == 0) ++lowest_word_;
    if (lowest_word_ == occupied_.size()) return false;
    const std::uint32_t bucket =
        lowest_word_ * 64 + static_cast<std::uint32_t>(std::countr_zero(occupied_[lowest_word_]));
    const std::uint32_t place = head_[bucket];
    Entry& entry = entries_[place];
    edge = entry.edge;
    head_[bucket] = entry.next;
    last_popped_next_ = entry.next;
    if (entry.next == kNone) occupied_[lowest_word_] &= occupied_[lowest_word_] - 1;
    entry.next = free_;
    free_ = place;
    return true;
  }

  /// The edge that the next pop will most likely take; nothing when that is not easy to say. For prefetching.
  const QueuedEdge* likely_next() const {
    const std::uint32_t place = last_popped_next_;
    return place == kNone ? nullptr : &entries_[place].edge;
  }

 private:
  static constexpr std::uint32_t kBuckets = 2048;
  static constexpr std::uint32_t kNone = 0xffffffffu;
  struct Entry {
    QueuedEdge edge;
    std::uint32_t next;
  };

  [[gnu::noinline, gnu::cold]] void make_room() { entries_.resize(2 * entries_.size() + 64); }

  // The upper bits of a positive float are its exponent and first mantissa bits: already a logarithmic scale.
  static std::uint32_t bucket_of(float cost) {
    constexpr int kMantissaBits = 5;
    constexpr std::int32_t kFirst = (127 - 44) << kMantissaBits;  // costs from 2^-44 on
    const auto scale = static_cast<std::int32_t>(std::bit_cast<std::uint32_t>(cost) >> (23 - kMantissaBits));
    return static_cast<std::uint32_t>(std::clamp<std::int32_t>(scale - kFirst, 0, kBuckets - 1));
  }

  std::vector<Entry> entries_;
  std::uint32_t used_ = 0;                             // entries that have ever held an edge
  std::uint32_t free_ = kNone;                         // taken entries, chained for reuse
  std::array<std::uint32_t, kBuckets> head_;           // first entry of each bucket
  std::array<std::uint64_t, kBuckets / 64> occupied_;  // one bit a bucket
  std::uint32_t last_popped_next_ = kNone;             // what lay behind the last popped entry in its bucket
  std::uint32_t lowest_word_ = 0;                      // no bit is set before this word
};

}  // namespace geosis
