#pragma once

#include <array>
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

  void clear();
  void push(QueuedEdge edge, float cost);

  /// Takes a cheapest edge; false when there is none.
  bool pop(QueuedEdge& edge);

 private:
  static constexpr std::uint32_t kBuckets = 2048;
  static constexpr std::uint32_t kNone = 0xffffffffu;
  struct Entry {
    QueuedEdge edge;
    std::uint32_t next;
  };

  static std::uint32_t bucket_of(float cost);

  std::vector<Entry> entries_;
  std::uint32_t free_ = kNone;                         // taken entries, chained for reuse
  std::array<std::uint32_t, kBuckets> head_;           // first entry of each bucket
  std::array<std::uint64_t, kBuckets / 64> occupied_;  // one bit a bucket
  std::uint32_t lowest_word_ = 0;                      // no bit is set before this word
};

}  // namespace geosis
