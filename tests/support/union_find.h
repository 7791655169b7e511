#pragma once

#include <cstdint>
#include <numeric>
#include <vector>

namespace geosis::test {

/// Disjoint sets over 0 ... size - 1.
class UnionFind {
 public:
  explicit UnionFind(std::int64_t size = 0) : parent_(static_cast<std::size_t>(size)) {
    std::iota(parent_.begin(), parent_.end(), std::int32_t{0});
  }

  std::int32_t add() {
    const auto id = static_cast<std::int32_t>(parent_.size());
    parent_.push_back(id);
    return id;
  }

  std::int32_t find(std::int32_t a) {
    while (parent_[a] != a) a = parent_[a] = parent_[parent_[a]];
    return a;
  }

  void unite(std::int32_t a, std::int32_t b) {
    a = find(a);
    b = find(b);
    if (a < b) parent_[b] = a;
    if (b < a) parent_[a] = b;
  }

  std::int64_t count() const {
    std::int64_t roots = 0;
    for (std::size_t a = 0; a < parent_.size(); ++a) roots += parent_[a] == static_cast<std::int32_t>(a);
    return roots;
  }

 private:
  std::vector<std::int32_t> parent_;
};

}  // namespace geosis::test
