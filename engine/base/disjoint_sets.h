#pragma once

#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace geosis {

/// Disjoint sets over 0 .. size - 1. The root of a set is its lowest element, whatever the order of unions.
class DisjointSets {
 public:
  /// All elements apart; the memory is kept.
  void reset(std::int32_t size) {
    parent_.resize(static_cast<std::size_t>(size));
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  std::int32_t size() const { return static_cast<std::int32_t>(parent_.size()); }

  std::int32_t root(std::int32_t n) {
    while (parent_[n] != n) n = parent_[n] = parent_[parent_[n]];
    return n;
  }

  void unite(std::int32_t a, std::int32_t b) {
    a = root(a);
    b = root(b);
    if (a > b) std::swap(a, b);
    parent_[b] = a;
  }

  /// Numbers the sets 0, 1, 2, ... by lowest element: element -> its set. Returns their count.
  std::int32_t number_sets(std::vector<std::int32_t>& set_of) {
    std::int32_t count = 0;
    set_of.resize(parent_.size());
    for (std::int32_t n = 0; n < size(); ++n) {
      const std::int32_t lowest = root(n);
      set_of[n] = lowest == n ? count++ : set_of[lowest];
    }
    return count;
  }

 private:
  std::vector<std::int32_t> parent_;
};

}  // namespace geosis
