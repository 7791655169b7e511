#include "engine/missing/plate/plate_gaps.h"

#include <algorithm>
#include <cstring>

#include "engine/base/disjoint_sets.h"

namespace geosis {
namespace {

constexpr std::size_t kNodesBetweenAsking = 1 << 15;

/// Whether a node lies between two wanted ones on an axis: numbers 1, 2 | 3, 4 | 5, 6 of the reach.
bool is_enclosed(std::uint32_t wanted) {
  const auto both = [wanted](std::uint32_t pair) { return (wanted & pair) == pair; };
  return both(0b110) || both(0b11000) || both(0b1100000);
}

/// Wanted nodes that share a stencil with another one, by rising place, and what lies round them.
struct JoinedNodes {
  std::vector<PlateNode> nodes;
  std::vector<std::uint32_t> wanted;  ///< as PlateSurroundings
};

class GapFinder {
 public:
  GapFinder(const GapBox& gap, const Progress& progress) : gap_(gap), progress_(progress), neighbours_(gap) {}

  PlateGaps find() {
    PlateGaps result;
    list_wanted(result.single);
    if (!joined_.nodes.empty() && !progress_.cancelled()) group(result);
    return result;
  }

 private:
  void list_wanted(std::vector<PlateNode>& single) {
    const GridShape shape = gap_.samples.shape;
    for (std::int32_t i = 0; i < shape.inlines; ++i) {
      for (std::int32_t j = 0; j < shape.crosslines; ++j) list_row(i, j, single);
      if (progress_.cancelled()) return;
    }
  }

  void list_row(std::int32_t i, std::int32_t j, std::vector<PlateNode>& single) {
    const std::size_t start = gap_.samples.at(i, j, 0);
    const NodeState* row = gap_.state.data() + start;
    const std::int32_t count = gap_.samples.shape.samples;
    for (std::int32_t k = 0; k < count; ++k) {
      const void* next = std::memchr(row + k, static_cast<int>(NodeState::wanted), static_cast<std::size_t>(count - k));
      if (next == nullptr) return;
      k = static_cast<std::int32_t>(static_cast<const NodeState*>(next) - row);
      const PlateSurroundings around = neighbours_.at(i, j, k);
      const PlateNode node{static_cast<std::uint32_t>(start + k), around.available};
      if (around.wanted == 1) {
        single.push_back(node);
      } else {
        joined_.nodes.push_back(node);
        joined_.wanted.push_back(around.wanted);
      }
    }
  }

  /// number[place] of the joined nodes; other places hold anything.
  std::vector<std::uint32_t> numbers() const {
    std::vector<std::uint32_t> number(gap_.state.size());
    for (std::size_t n = 0; n < joined_.nodes.size(); ++n)
      number[joined_.nodes[n].place] = static_cast<std::uint32_t>(n);
    return number;
  }

  DisjointSets join() const {
    const auto number = numbers();
    const auto& strides = neighbours_.strides();
    DisjointSets groups;
    groups.reset(static_cast<std::int32_t>(joined_.nodes.size()));
    for (std::size_t n = 0; n < joined_.nodes.size(); ++n) {
      if (n % kNodesBetweenAsking == 0 && progress_.cancelled()) return groups;
      for (int m = 1; m < kPlateReach; ++m)
        if (strides[m] < 0 && ((joined_.wanted[n] >> m) & 1) != 0)
          groups.unite(static_cast<std::int32_t>(n),
                       static_cast<std::int32_t>(number[joined_.nodes[n].place + strides[m]]));
    }
    return groups;
  }

  /// Nodes sorted by gap, by counting.
  void group(PlateGaps& result) const {
    const std::size_t count = joined_.nodes.size();
    DisjointSets groups = join();
    std::vector<std::uint32_t> gap_of(count), enclosed;
    for (std::size_t n = 0; n < count; ++n) {
      const std::int32_t root = groups.root(static_cast<std::int32_t>(n));
      if (static_cast<std::size_t>(root) == n) {
        gap_of[n] = static_cast<std::uint32_t>(result.gaps.size());
        result.gaps.push_back({});
        enclosed.push_back(0);
      } else {
        gap_of[n] = gap_of[root];
      }
      PlateGap& gap = result.gaps[gap_of[n]];
      ++gap.last;
      gap.wide = gap.wide || is_heart_of_wide(n);
      enclosed[gap_of[n]] += is_enclosed(joined_.wanted[n]);
    }
    std::uint32_t before = 0;
    for (std::size_t g = 0; g < result.gaps.size(); ++g) {
      PlateGap& gap = result.gaps[g];
      const std::uint32_t size = gap.last;
      gap.scattered = std::uint64_t{4} * enclosed[g] < size;
      gap.first = gap.last = before;
      before += size;
    }
    result.nodes.resize(count);
    for (std::size_t n = 0; n < count; ++n) result.nodes[result.gaps[gap_of[n]].last++] = joined_.nodes[n];
  }

  /// Middle of a cube of 5^3 wanted nodes?
  bool is_heart_of_wide(std::size_t n) const {
    if (joined_.wanted[n] != kWholePlate) return false;
    const NodeState* here = gap_.state.data() + joined_.nodes[n].place;
    const std::ptrdiff_t row = gap_.samples.shape.samples, plane = row * gap_.samples.shape.crosslines;
    for (int i = -2; i <= 2; ++i)
      for (int j = -2; j <= 2; ++j)
        for (int k = -2; k <= 2; ++k)
          if (here[i * plane + j * row + k] != NodeState::wanted) return false;
    return true;
  }

  const GapBox& gap_;
  const Progress& progress_;
  PlateNeighbours neighbours_;
  JoinedNodes joined_;
};

}  // namespace

PlateGaps find_plate_gaps(const GapBox& gap, const Progress& progress) {
  return GapFinder(gap, progress).find();
}

}  // namespace geosis
