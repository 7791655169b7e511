#include "engine/simplify/partition.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "engine/base/parallel.h"

namespace geosis {
namespace {

/// Fixed, so that the pieces in which work is shared out do not depend on the number of threads.
constexpr std::size_t kChunks = 16;

struct Range {
  std::size_t begin, end;
};

Range chunk_of(std::size_t size, std::size_t chunk) {
  return {size * chunk / kChunks, size * (chunk + 1) / kChunks};
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

std::vector<std::int32_t> morton_order(const WorkingMesh& mesh, std::uint32_t pass, int threads) {
  const std::size_t vertices = mesh.vertices.size();
  const CellGrid grid(mesh.bounds, grid_bits(vertices), pass);
  std::vector<std::uint32_t> keys(vertices);
  parallel_for(kChunks, threads, [&](std::size_t chunk) {
    const auto [begin, end] = chunk_of(vertices, chunk);
    for (std::size_t v = begin; v < end; ++v) keys[v] = grid.key(mesh.vertices[v].position);
  });
  std::vector<std::uint32_t> next(grid.cells() + 1, 0);
  for (const std::uint32_t key : keys) ++next[key + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<std::int32_t> order(vertices);
  for (std::size_t v = 0; v < vertices; ++v) order[next[keys[v]]++] = static_cast<std::int32_t>(v);
  return order;
}

std::vector<std::int32_t> inverse(const std::vector<std::int32_t>& order) {
  std::vector<std::int32_t> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) place[order[i]] = static_cast<std::int32_t>(i);
  return place;
}

/// Sorts triangles to windows: a stable counting sort in chunks, for those inside and those that cross at once.
class TriangleSort {
 public:
  TriangleSort(const WorkingMesh& mesh, const std::vector<std::int32_t>& place, Partition& partition)
      : mesh_(mesh), place_(place), partition_(partition), windows_(static_cast<std::size_t>(partition.windows)) {}

  void run(int threads) {
    inside_.assign(kChunks * windows_, 0);
    crossing_.assign(kChunks * windows_, 0);
    parallel_for(kChunks, threads, [&](std::size_t chunk) { count(chunk); });
    partition_.triangles.resize(sum_up(inside_, partition_.first_triangle));
    partition_.crossing.resize(sum_up(crossing_, partition_.first_crossing));
    parallel_for(kChunks, threads, [&](std::size_t chunk) { place_triangles(chunk); });
  }

 private:
  /// The triangle over places, the window of its first vertex, and whether the others lie there too.
  struct Placed {
    Triangle triangle;
    std::int32_t window;
    bool inside;
  };

  Placed placed(std::size_t t) const {
    const auto& [a, b, c] = mesh_.triangles[t];
    const Triangle triangle{place_[a], place_[b], place_[c]};
    const std::int32_t window = triangle[0] / partition_.window_size;
    const std::int32_t first = partition_.first_vertex(window);
    const auto here = [&](std::int32_t v) { return v >= first && v < first + partition_.window_size; };
    return {triangle, window, here(triangle[1]) && here(triangle[2])};
  }

  void count(std::size_t chunk) {
    const auto [begin, end] = chunk_of(mesh_.triangles.size(), chunk);
    for (std::size_t t = begin; t < end; ++t) {
      const Placed p = placed(t);
      ++(p.inside ? inside_ : crossing_)[chunk * windows_ + p.window];
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

  void place_triangles(std::size_t chunk) {
    const auto [begin, end] = chunk_of(mesh_.triangles.size(), chunk);
    for (std::size_t t = begin; t < end; ++t) {
      const auto [triangle, window, inside] = placed(t);
      if (!inside) {
        partition_.crossing[crossing_[chunk * windows_ + window]++] = triangle;
        continue;
      }
      LocalTriangle& local = partition_.triangles[inside_[chunk * windows_ + window]++];
      const std::int32_t first = partition_.first_vertex(window);
      for (int k = 0; k < 3; ++k) local[k] = static_cast<LocalVertex>(triangle[k] - first);
    }
  }

  const WorkingMesh& mesh_;
  const std::vector<std::int32_t>& place_;
  Partition& partition_;
  const std::size_t windows_;
  std::vector<std::size_t> inside_, crossing_;  // (chunks, windows)
};

}  // namespace

std::int32_t Partition::vertices(std::int32_t window) const {
  return std::min(window_size, static_cast<std::int32_t>(order.size()) - first_vertex(window));
}

Partition make_partition(const WorkingMesh& mesh, std::int32_t window_size, std::uint32_t pass, int threads) {
  const auto vertices = static_cast<std::int32_t>(mesh.vertices.size());
  Partition partition;
  partition.window_size = window_size;
  partition.windows = vertices / window_size + (vertices % window_size != 0);
  if (partition.windows > 1) {
    partition.order = morton_order(mesh, pass, threads);
  } else {
    partition.order.resize(mesh.vertices.size());
    std::iota(partition.order.begin(), partition.order.end(), 0);
  }
  TriangleSort(mesh, inverse(partition.order), partition).run(threads);
  partition.locked.assign(mesh.vertices.size(), 0);
  for (const Triangle& triangle : partition.crossing) {
    for (const std::int32_t v : triangle) partition.locked[v] = 1;
  }
  return partition;
}

}  // namespace geosis
