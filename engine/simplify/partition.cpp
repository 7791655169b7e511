#include "engine/simplify/partition.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <numeric>
#include <utility>

#include "engine/base/parallel.h"
#include "engine/simplify/chunks.h"

namespace geosis {
namespace {

/// Calls visit(v) for every vertex of one chunk of the mesh's segments, in order.
template <class Visit>
void for_vertices(const WorkingMesh& mesh, std::size_t chunk, const Visit& visit) {
  const auto [first, last] = chunk_of(mesh.vertices(), chunk);
  std::size_t before = 0;  // live vertices in the segments so far
  for (const auto& [begin, end] : mesh.segments()) {
    const std::size_t size = end - begin;
    if (before >= last) return;
    const std::size_t from = std::max(first, before) - before;
    const std::size_t to = std::min(last, before + size) - before;
    for (std::size_t i = std::min(from, size); i < to; ++i) visit(begin + i);
    before += size;
  }
}

/// A cube of 2^bits cells an axis over the mesh; the cells are numbered in Morton order from a shifted origin.
class CellGrid {
 public:
  CellGrid(const Box& bounds, int bits, std::uint32_t pass) : low_(bounds.low), cells_(std::uint32_t{1} << bits) {
    const Vec3f size = bounds.high - bounds.low;
    cells_per_voxel_ = static_cast<float>(cells_) / (std::max({size.x, size.y, size.z}) * 1.0001f + kLatticeStep);
    // Fractional parts of irrational numbers, in units of 2^-32.
    constexpr std::uint32_t kShift[3] = {0x61c88647u, 0x497f62b7u, 0x71374491u};
    for (int axis = 0; axis < 3; ++axis) {
      const std::uint32_t shift = static_cast<std::uint32_t>(std::uint64_t{kShift[axis] * pass} * cells_ >> 32);
      spread_[axis].resize(cells_);
      for (std::uint32_t i = 0; i < cells_; ++i) spread_[axis][i] = spread((i + shift) % cells_) << axis;
    }
  }

  std::uint32_t cells() const { return cells_ * cells_ * cells_; }

  std::uint32_t key(Vec3f p) const {
    std::uint32_t key = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const auto cell = static_cast<std::uint32_t>((p[axis] - low_[axis]) * cells_per_voxel_);
      key |= spread_[axis][std::min(cell, cells_ - 1)];
    }
    return key;
  }

 private:
  static std::uint32_t spread(std::uint32_t x) {
    std::uint32_t result = 0;
    for (int bit = 0; bit < 10; ++bit) result |= (x >> bit & 1u) << (3 * bit);
    return result;
  }

  Vec3f low_;
  std::uint32_t cells_;
  float cells_per_voxel_;
  std::array<std::vector<std::uint32_t>, 3> spread_;
};

/// About 16 vertices a cell, at most 128 cells an axis.
int grid_bits(std::size_t vertices) {
  int bits = 2;
  while (bits < 7 && (std::size_t{1} << (3 * bits)) < vertices / 16) ++bits;
  return bits;
}

/// Vertices in the order of their cells, and in a cell in the mesh's order: a stable counting sort in chunks.
class MortonSort {
 public:
  MortonSort(const WorkingMesh& mesh, std::uint32_t pass)
      : mesh_(mesh), grid_(mesh.bounds(), grid_bits(mesh.vertices()), pass), keys_(mesh.slots()) {}

  void run(int threads, Buffer<std::int32_t>& order, Buffer<std::int32_t>& place) {
    next_.assign(kChunks * grid_.cells(), 0);
    parallel_for(kChunks, threads, [&](std::size_t chunk) {
      std::uint32_t* count = &next_[chunk * grid_.cells()];
      for_vertices(mesh_, chunk, [&](std::size_t v) { ++count[keys_[v] = grid_.key(mesh_.position(v))]; });
    });
    sum_up();
    parallel_for(kChunks, threads, [&](std::size_t chunk) {
      std::uint32_t* next = &next_[chunk * grid_.cells()];
      for_vertices(mesh_, chunk, [&](std::size_t v) {
        const std::uint32_t at = next[keys_[v]]++;
        order[at] = static_cast<std::int32_t>(v);
        place[v] = static_cast<std::int32_t>(at);
      });
    });
  }

 private:
  /// Turns counts into the places where each chunk's next vertex of a cell goes.
  void sum_up() {
    std::uint32_t sum = 0;
    for (std::size_t cell = 0; cell < grid_.cells(); ++cell) {
      for (std::size_t chunk = 0; chunk < kChunks; ++chunk) {
        sum += std::exchange(next_[chunk * grid_.cells() + cell], sum);
      }
    }
  }

  const WorkingMesh& mesh_;
  const CellGrid grid_;
  Buffer<std::uint32_t> keys_;
  std::vector<std::uint32_t> next_;  // (chunks, cells)
};

/// Sorts triangles to windows: a stable counting sort in chunks, for those inside and those that cross at once.
class TriangleSort {
 public:
  TriangleSort(std::span<const Triangle> triangles, const Buffer<std::int32_t>& place, Partition& partition)
      : triangles_(triangles),
        place_(place),
        partition_(partition),
        shift_(std::countr_zero(static_cast<std::uint32_t>(partition.window_size))),
        windows_(static_cast<std::size_t>(partition.windows)) {}

  void run(int threads) {
    inside_.assign(kChunks * windows_, 0);
    crossing_.assign(kChunks * windows_, 0);
    for_chunks(triangles_.size(), threads, [&](auto... piece) { count(piece...); });
    partition_.triangles = Buffer<LocalTriangle>(sum_up(inside_, partition_.first_triangle) + 1);
    partition_.crossing = Buffer<Triangle>(sum_up(crossing_, partition_.first_crossing) + 1);
    for_chunks(triangles_.size(), threads, [&](auto... piece) { place_triangles(piece...); });
  }

 private:
  /// The triangle over places, the window of its first vertex, and whether the others lie there too.
  struct Placed {
    Triangle triangle;
    std::int32_t window;
    bool inside;
  };

  Placed placed(std::size_t t) const {
    const auto& [a, b, c] = triangles_[t];
    const Triangle triangle{place_[a], place_[b], place_[c]};
    const bool inside = (((triangle[0] ^ triangle[1]) | (triangle[0] ^ triangle[2])) >> shift_) == 0;
    return {triangle, triangle[0] >> shift_, inside};
  }

  void count(std::size_t chunk, std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const Placed p = placed(t);
      ++(p.inside ? inside_ : crossing_)[chunk * windows_ + static_cast<std::size_t>(p.window)];
    }
  }

  /// Turns counts into the places where each chunk's next triangle of a window goes; returns how many there are.
  std::size_t sum_up(std::vector<std::size_t>& counts, std::vector<std::size_t>& first) const {
    first.resize(windows_ + 1);
    std::size_t sum = 0;
    for (std::size_t window = 0; window < windows_; ++window) {
      first[window] = sum;
      for (std::size_t chunk = 0; chunk < kChunks; ++chunk) {
        sum += std::exchange(counts[chunk * windows_ + window], sum);
      }
    }
    return first[windows_] = sum;
  }

  void place_triangles(std::size_t chunk, std::size_t begin, std::size_t end) {
    const std::int32_t within = partition_.window_size - 1;
    for (std::size_t t = begin; t < end; ++t) {
      const auto [triangle, window, inside] = placed(t);
      const std::size_t at = chunk * windows_ + static_cast<std::size_t>(window);
      if (!inside) {
        partition_.crossing[crossing_[at]++] = triangle;
        continue;
      }
      LocalTriangle& local = partition_.triangles[inside_[at]++];
      for (int k = 0; k < 3; ++k) local[k] = static_cast<LocalVertex>(triangle[k] & within);
    }
  }

  std::span<const Triangle> triangles_;
  const Buffer<std::int32_t>& place_;
  Partition& partition_;
  const int shift_;
  const std::size_t windows_;
  std::vector<std::size_t> inside_, crossing_;  // (chunks, windows)
};

void keep_order(const WorkingMesh& mesh, Buffer<std::int32_t>& order, Buffer<std::int32_t>& place) {
  std::int32_t at = 0;
  for (const auto& [begin, end] : mesh.segments()) {
    for (std::size_t v = begin; v < end; ++v) {
      order[at] = static_cast<std::int32_t>(v);
      place[v] = at++;
    }
  }
}

}  // namespace

std::int32_t Partition::vertices(std::int32_t window) const {
  return std::min(window_size, static_cast<std::int32_t>(order.size()) - first_vertex(window));
}

Partition make_partition(const WorkingMesh& mesh, std::int32_t window_size, std::uint32_t pass, int threads) {
  const auto vertices = static_cast<std::int32_t>(mesh.vertices());
  Partition partition;
  partition.window_size = window_size;
  partition.windows = vertices / window_size + (vertices % window_size != 0);
  partition.order = Buffer<std::int32_t>(mesh.vertices());
  Buffer<std::int32_t> place(mesh.slots());
  if (partition.windows > 1) {
    MortonSort(mesh, pass).run(threads, partition.order, place);
  } else {
    keep_order(mesh, partition.order, place);
  }
  TriangleSort(mesh.triangles(), place, partition).run(threads);
  partition.locked.assign(mesh.vertices(), 0);
  for_chunks(partition.first_crossing.back(), threads, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      for (const std::int32_t v : partition.crossing[t]) {
        std::atomic_ref(partition.locked[v]).store(1, std::memory_order_relaxed);
      }
    }
  });
  return partition;
}

}  // namespace geosis
