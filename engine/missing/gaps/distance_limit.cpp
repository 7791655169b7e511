#include "engine/missing/gaps/distance_limit.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/parallel.h"

namespace geosis {
namespace {

/// Squared distances to valid samples within one layer of samples, line by line.
///
/// Each site's squares make a parabola; their lower envelope is swept once forwards (which site rules from where) and
/// once backwards (its value). Source: Meijster, Roerdink, Hesselink 2000, in integers throughout.
class Envelope {
 public:
  explicit Envelope(std::int32_t longest)
      : site_(static_cast<std::size_t>(longest)), from_(site_.size()), height_(site_.size()) {}

  /// Replaces g(x) by the smallest g(u) + (x - u)^2; values from `far` on count as none.
  void lower(std::int64_t* line, std::size_t stride, std::int32_t n, std::int64_t far) {
    std::ptrdiff_t top = -1;
    for (std::int32_t u = 0; u < n; ++u) {
      const std::int64_t g = line[static_cast<std::size_t>(u) * stride];
      height_[static_cast<std::size_t>(u)] = g;
      if (g >= far) continue;
      while (top >= 0 && at(from(top), site(top)) > at(from(top), u)) --top;
      const std::int64_t begin = top < 0 ? 0 : 1 + last_of(site(top), u);
      if (begin >= n) continue;
      ++top;
      site_[static_cast<std::size_t>(top)] = u;
      from_[static_cast<std::size_t>(top)] = static_cast<std::int32_t>(begin);
    }
    for (std::int32_t x = n - 1; x >= 0 && top >= 0; --x) {
      line[static_cast<std::size_t>(x) * stride] = std::min(far, at(x, site(top)));
      if (x == from(top)) --top;
    }
  }

 private:
  std::int32_t site(std::ptrdiff_t s) const { return site_[static_cast<std::size_t>(s)]; }
  std::int32_t from(std::ptrdiff_t s) const { return from_[static_cast<std::size_t>(s)]; }
  std::int64_t at(std::int32_t x, std::int32_t u) const {
    return height_[static_cast<std::size_t>(u)] + std::int64_t{x - u} * (x - u);
  }
  /// The last x at which u is at least as near as v > u; the caller knows that there is one.
  std::int64_t last_of(std::int32_t u, std::int32_t v) const {
    const std::int64_t heights = height_[static_cast<std::size_t>(v)] - height_[static_cast<std::size_t>(u)];
    return (std::int64_t{v} * v - std::int64_t{u} * u + heights) / (2 * std::int64_t{v - u});
  }

  std::vector<std::int32_t> site_, from_;
  std::vector<std::int64_t> height_;
};

class Limit {
 public:
  Limit(double limit, GridShape shape, const BitLines& valid, BitLines& nodes, const Progress& progress)
      : limit_(limit), shape_(shape), valid_(valid), nodes_(nodes), progress_(progress) {
    far_ = static_cast<std::int64_t>(std::min(limit * limit, 1e15)) + 1;
    reach_ = static_cast<std::int32_t>(std::min(limit, 1e6));
  }

  /// 64 layers of samples, which share words of bits.
  void drop_in(std::size_t word) {
    const std::uint64_t undecided = undecided_layers(word);
    std::vector<std::int64_t> squares;
    Envelope envelope(std::max(shape_.inlines, shape_.crosslines));
    const std::int32_t end = std::min(static_cast<std::int32_t>(word + 1) * 64, shape_.samples);
    for (std::int32_t k = static_cast<std::int32_t>(word) * 64; k < end && !progress_.cancelled(); ++k) {
      if ((undecided >> k % 64 & 1) == 0) continue;
      squares.resize(static_cast<std::size_t>(shape_.inlines) * static_cast<std::size_t>(shape_.crosslines));
      if (measure(k, squares, envelope)) drop_far(k, squares);
    }
  }

 private:
  std::size_t trace(std::int32_t i, std::int32_t j) const {
    return static_cast<std::size_t>(i) * shape_.crosslines + j;
  }

  /// Layers with a node that has no valid sample within the limit on its lines.
  std::uint64_t undecided_layers(std::size_t word) const {
    std::uint64_t layers = 0;
    for (std::int32_t i = 0; i < shape_.inlines && !progress_.cancelled(); ++i)
      for (std::int32_t j = 0; j < shape_.crosslines; ++j) layers |= undecided_nodes(i, j, word);
    return layers;
  }
  std::uint64_t undecided_nodes(std::int32_t i, std::int32_t j, std::size_t word) const {
    std::uint64_t left = nodes_.line(trace(i, j))[word];
    for (std::int32_t n = 1; n <= reach_ && left != 0; ++n) {
      if (i - n >= 0) left &= ~valid_.line(trace(i - n, j))[word];
      if (i + n < shape_.inlines) left &= ~valid_.line(trace(i + n, j))[word];
      if (j - n >= 0) left &= ~valid_.line(trace(i, j - n))[word];
      if (j + n < shape_.crosslines) left &= ~valid_.line(trace(i, j + n))[word];
      if (i - n < 0 && j - n < 0 && i + n >= shape_.inlines && j + n >= shape_.crosslines) break;
    }
    std::uint64_t undecided = 0;
    for (; left != 0; left &= left - 1) {
      const auto k = static_cast<std::int32_t>(word * 64) + std::countr_zero(left);
      if (static_cast<double>(square_on_trace({i, j, k})) > limit_ * limit_) undecided |= left & (~left + 1);
    }
    return undecided;
  }
  /// False when cancelled.
  bool measure(std::int32_t k, std::span<std::int64_t> squares, Envelope& envelope) const {
    const auto crosslines = static_cast<std::size_t>(shape_.crosslines);
    for (std::int32_t i = 0; i < shape_.inlines; ++i) {
      if (progress_.cancelled()) return false;
      for (std::int32_t j = 0; j < shape_.crosslines; ++j) squares[trace(i, j)] = square_on_trace({i, j, k});
      envelope.lower(&squares[trace(i, 0)], 1, shape_.crosslines, far_);
    }
    for (std::size_t j = 0; j < crosslines && !progress_.cancelled(); ++j)
      envelope.lower(&squares[j], crosslines, shape_.inlines, far_);
    return !progress_.cancelled();
  }
  std::int64_t square_on_trace(GridIndex node) const {
    const std::size_t line = trace(node.i, node.j);
    if (valid_.test(line, node.k)) return 0;
    std::int64_t square = far_;
    for (const std::int32_t next : {valid_.before(line, node.k), valid_.after(line, node.k)})
      if (next >= 0) square = std::min(square, std::int64_t{next - node.k} * (next - node.k));
    return square;
  }
  void drop_far(std::int32_t k, std::span<const std::int64_t> squares) {
    for (std::size_t line = 0; line < squares.size(); ++line)
      if (static_cast<double>(squares[line]) > limit_ * limit_)
        nodes_.line(line)[static_cast<std::size_t>(k) / 64] &= ~(std::uint64_t{1} << k % 64);
  }

  double limit_;
  std::int64_t far_;    ///< stands for every square above the limit's
  std::int32_t reach_;  ///< whole steps within the limit
  GridShape shape_;
  const BitLines& valid_;
  BitLines& nodes_;
  const Progress& progress_;
};

}  // namespace

void drop_beyond(double limit, GridShape shape, const BitLines& valid, BitLines& nodes, int threads,
                 const Progress& progress) {
  double diagonal = 0;
  for (int axis = 0; axis < 3; ++axis) diagonal += double(shape[axis]) * shape[axis];
  if (limit * limit >= diagonal) return;
  Limit dropper(limit, shape, valid, nodes, progress);
  parallel_for(nodes.words(), threads, [&](std::size_t word) { dropper.drop_in(word); });
}

}  // namespace geosis
