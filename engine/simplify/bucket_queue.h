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
///
/// A bucket is a chain of cache lines of seven edges: walking it misses the cache once in seven edges.
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
    const std::size_t chunks = edges / kEdgesInChunk + kBuckets / 4;
    if (chunks_.size() < chunks) chunks_.resize(chunks);
  }

  void push(QueuedEdge edge, float cost) {
    const std::uint32_t bucket = bucket_of(cost);
    std::uint32_t head = head_[bucket];
    if (head == kNone || chunks_[head].count == kEdgesInChunk) head = head_[bucket] = new_chunk(head, bucket);
    Chunk& chunk = chunks_[head];
    chunk.edges[chunk.count++] = edge;
  }

  /// Takes a cheapest edge; false when there is none.
  bool pop(QueuedEdge& edge) {
    while (lowest_word_ < occupied_.size() && occupied_[lowest_word_] == 0) ++lowest_word_;
    if (lowest_word_ == occupied_.size()) return false;
    std::uint64_t& word = occupied_[lowest_word_];
    const std::uint32_t bucket = lowest_word_ * 64 + static_cast<std::uint32_t>(std::countr_zero(word));
    const std::uint32_t head = head_[bucket];
    Chunk& chunk = chunks_[head];
    edge = chunk.edges[--chunk.count];
    next_ = head;
    if (chunk.count > 0) {
      if (chunk.count == 1 && chunk.next != kNone) __builtin_prefetch(&chunks_[chunk.next]);
      return true;
    }
    head_[bucket] = chunk.next;
    if (chunk.next == kNone) word &= word - 1;
    next_ = word == 0 ? kNone : head_[lowest_word_ * 64 + static_cast<std::uint32_t>(std::countr_zero(word))];
    chunk.next = free_;
    free_ = head;
    return true;
  }

  /// The edge that the next pop will most likely take; nothing when that is not easy to say. For prefetching.
  const QueuedEdge* likely_next() const {
    return next_ == kNone ? nullptr : &chunks_[next_].edges[chunks_[next_].count - 1];
  }

 private:
  static constexpr std::uint32_t kBuckets = 2048;
  static constexpr std::uint32_t kEdgesInChunk = 7;
  static constexpr std::uint32_t kNone = 0xffffffffu;
  struct alignas(64) Chunk {
    std::array<QueuedEdge, kEdgesInChunk> edges;
    std::uint32_t count;  // 1 ... 7 while it belongs to a bucket
    std::uint32_t next;
  };

  /// An empty chunk before `next` in the bucket.
  std::uint32_t new_chunk(std::uint32_t next, std::uint32_t bucket) {
    std::uint32_t chunk = free_;
    if (chunk != kNone) {
      free_ = chunks_[chunk].next;
    } else {
      chunk = used_++;
      if (chunk == chunks_.size()) make_room();
    }
    chunks_[chunk].count = 0;
    chunks_[chunk].next = next;
    occupied_[bucket / 64] |= std::uint64_t{1} << (bucket % 64);
    lowest_word_ = std::min(lowest_word_, bucket / 64);
    return chunk;
  }

  [[gnu::noinline, gnu::cold]] void make_room() { chunks_.resize(2 * chunks_.size() + 64); }

  // The upper bits of a positive float are its exponent and first mantissa bits: already a logarithmic scale.
  static std::uint32_t bucket_of(float cost) {
    constexpr int kMantissaBits = 5;
    constexpr std::int32_t kFirst = (127 - 44) << kMantissaBits;  // costs from 2^-44 on
    const auto scale = static_cast<std::int32_t>(std::bit_cast<std::uint32_t>(cost) >> (23 - kMantissaBits));
    return static_cast<std::uint32_t>(std::clamp<std::int32_t>(scale - kFirst, 0, kBuckets - 1));
  }

  std::vector<Chunk> chunks_;
  std::uint32_t used_ = 0;                             // chunks that have ever belonged to a bucket
  std::uint32_t free_ = kNone;                         // emptied chunks, chained for reuse
  std::array<std::uint32_t, kBuckets> head_;           // first chunk of each bucket
  std::array<std::uint64_t, kBuckets / 64> occupied_;  // one bit a bucket
  std::uint32_t next_ = kNone;                         // the chunk of the edge after the one popped last, if close by
  std::uint32_t lowest_word_ = 0;                      // no bit is set before this word
};

}  // namespace geosis
