#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/volume/grid.h"

namespace geosis {

/// Which sample of each trace every layer of a structural grid passes: per trace a path of whole numbers that begins
/// with sample 0, ends with the last one, and goes on by 0 or 1 from layer to layer. So every sample is a node, no two
/// layers cross, and the layers' cells fill the box once.
///
/// A path is kept as one bit a step. For any thread: set different traces, then read.
class LayerPaths {
 public:
  LayerPaths() = default;
  /// layers   at least shape.samples.
  LayerPaths(GridShape shape, std::int32_t layers);
  /// From words(), whatever they hold: see is_sound().
  LayerPaths(GridShape shape, std::int32_t layers, std::vector<std::uint64_t> words);

  GridShape shape() const { return shape_; }  ///< of the volume
  std::int32_t layers() const { return layers_; }
  /// Nodes of the structural grid: (inlines, crosslines, layers).
  GridShape grid() const { return {shape_.inlines, shape_.crosslines, layers_}; }

  /// samples   (layers) of the trace at (i, j): a path as above.
  void set(std::int32_t i, std::int32_t j, std::span<const std::int32_t> samples);
  /// samples   (layers), written.
  void get(std::int32_t i, std::int32_t j, std::span<std::int32_t> samples) const;
  /// The sample at a node of the structural grid. O(layers / 64).
  std::int32_t sample_at(std::int32_t i, std::int32_t j, std::int32_t layer) const;
  /// The first layer that passes sample k of the trace. O(layers / 64).
  std::int32_t layer_of(std::int32_t i, std::int32_t j, std::int32_t k) const;

  /// Whether every trace has a path; what comes from a file may not.
  bool is_sound() const;
  /// Bit b of word w of a trace: the path goes on by one from layer 64 w + b to the next.
  std::span<const std::uint64_t> words() const { return words_; }
  static std::size_t word_count(GridShape shape, std::int32_t layers);

 private:
  std::span<const std::uint64_t> trace(std::int32_t i, std::int32_t j) const;

  GridShape shape_;
  std::int32_t layers_ = 0;
  std::size_t words_a_trace_ = 0;
  std::vector<std::uint64_t> words_;
};

}  // namespace geosis
