#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/missing/plate/steered_paths.h"

namespace geosis {

/// The second differences of the steered plate at a node, by the axes they go along.
enum Term : std::size_t { ii, jj, kk, ij, ik, jk, terms };

/// One trace's terms: the rows from which they are made and to which they go back. Rows have one place before the trace
/// and two after it, for terms that reach a sample up or down; places are counted from the trace's first sample.
class TraceTerms {
 public:
  explicit TraceTerms(std::int32_t samples);

  /// Samples first ... end - 1 of the trace have terms, a bit each in `set`; mixed ones look one sample further down.
  void select(const std::uint8_t* set, std::int32_t first, std::int32_t end);

  /// Lagrange's cubics through four samples of neighbour n's trace around each depth.
  void aim(Neighbour n, const float* depth, std::int32_t first, std::int32_t end);
  /// Aims where the selected terms look.
  void aim(Neighbour n, const float* depth) { aim(n, depth, first_, reached_); }
  /// The factor of the sample base(n, k) + t in neighbour n's value for sample k.
  float factor(Neighbour n, std::int32_t k, std::size_t t) const { return taps_[n].factor[t][place(k)]; }
  std::int32_t base(Neighbour n, std::int32_t k) const { return taps_[n].base[place(k)]; }

  /// Loads what the terms are made of.
  void load_own(const float* trace);
  void load_neighbour(Neighbour n, const float* trace);

  /// The selected terms times their weights.
  void evaluate(const std::array<float, terms>& weight);
  /// After evaluate(): what the terms give back, which the store functions add to traces.
  void give_back();
  /// In place of load, evaluate and give_back: the squares of what a unit sample would give to itself.
  void give_back_squares(const std::array<float, terms>& weight);
  void store_own(float* trace) const;
  void store_neighbour(Neighbour n, float* trace) const;

 private:
  using Row = std::vector<float>;
  struct Taps {
    std::vector<std::int32_t> base;  // the first of four samples
    std::array<Row, 4> factor;
  };

  /// minus and middle: what becomes of the factors -1 and -2 in the terms.
  void collect(float minus, float middle);
  static std::size_t place(std::int32_t k) { return static_cast<std::size_t>(k) + 1; }

  std::int32_t samples_, first_ = 0, end_ = 0, reached_ = 0;
  std::array<Taps, neighbours> taps_;
  std::array<Row, neighbours> lateral_;  // values on the neighbours' traces; later what goes back there
  std::array<Row, terms> term_;
  Row own_;
};

}  // namespace geosis
