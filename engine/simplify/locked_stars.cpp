#include "engine/simplify/locked_stars.h"

#include <atomic>
#include <span>

#include "engine/base/parallel.h"
#include "engine/simplify/chunks.h"
#include "engine/simplify/first_star.h"

namespace geosis {
namespace {

/// Calls visit(a, b, c) for each corner a of each triangle with a locked vertex, over places: first those inside
/// windows, window by window on several threads, then the crossing ones. A window's triangles have its own vertices
/// alone.
template <class Visit>
void for_corners(Partition& partition, int threads, const Visit& visit) {
  const auto visit_all = [&](std::int32_t a, std::int32_t b, std::int32_t c) {
    visit(a, b, c);
    visit(b, c, a);
    visit(c, a, b);
  };
  parallel_for(static_cast<std::size_t>(partition.windows), threads, [&](std::size_t window) {
    const auto w = static_cast<std::int32_t>(window);
    const std::int32_t first = partition.first_vertex(w);
    const std::uint8_t* locked = &partition.locked[first];
    for (const auto& [a, b, c] : partition.triangles_of(w)) {
      if ((locked[a] | locked[b] | locked[c]) != 0) visit_all(first + a, first + b, first + c);
    }
  });
  for (std::int32_t w = 0; w < partition.windows; ++w) {
    for (const auto& [a, b, c] : partition.crossing_of(w)) visit_all(a, b, c);
  }
}

}  // namespace

LockedStars::LockedStars(const WorkingMesh& mesh, Partition& partition, int threads, const Watch& watch)
    : slot_(partition.locked.size()) {
  for (std::size_t place = 0; place < partition.locked.size(); ++place) {
    if (!partition.locked[place]) continue;
    slot_[place] = static_cast<std::int32_t>(places_.size());
    places_.push_back(static_cast<std::int32_t>(place));
  }
  vertices_ = Buffer<WorkingVertex>(places_.size());
  count(partition, threads);
  if (watch.is_cancelled()) return;
  fill(partition, threads);
  if (watch.is_cancelled()) return;
  start(mesh, partition, threads);
  is_made_ = true;
}

void LockedStars::count(Partition& partition, int threads) {
  first_.assign(places_.size() + 1, 0);
  for_corners(partition, threads, [&](std::int32_t a, std::int32_t, std::int32_t) {
    if (partition.locked[a]) ++first_[slot_[a] + 1];
  });
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
}

void LockedStars::fill(Partition& partition, int threads) {
  pairs_ = Buffer<Pair>(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for_corners(partition, threads, [&](std::int32_t a, std::int32_t b, std::int32_t c) {
    if (partition.locked[a]) pairs_[next[slot_[a]]++] = {b, c};
  });
}

void LockedStars::start(const WorkingMesh& mesh, const Partition& partition, int threads) {
  std::atomic<bool> sound = true;
  const auto position = [&](std::int32_t place) { return mesh.position(partition.order[place]); };
  for_chunks(places_.size(), threads, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      vertices_[i] = mesh.vertex(partition.order[places_[i]]);
      const std::span<const Pair> ring(pairs_.data() + first_[i], first_[i + 1] - first_[i]);
      if (!start_vertex(vertices_[i], places_[i], ring, position)) sound = false;
    }
  });
  is_manifold_ = sound;
}

}  // namespace geosis
