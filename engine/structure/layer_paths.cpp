#include "engine/structure/layer_paths.h"

#include <bit>
#include <cassert>
#include <utility>

namespace geosis {
namespace {

constexpr std::size_t kBits = 64;

std::size_t words_for(std::int32_t layers) {
  return (static_cast<std::size_t>(layers) + kBits - 1) / kBits;
}

}  // namespace

std::size_t LayerPaths::word_count(GridShape shape, std::int32_t layers) {
  return static_cast<std::size_t>(shape.inlines) * static_cast<std::size_t>(shape.crosslines) * words_for(layers);
}

LayerPaths::LayerPaths(GridShape shape, std::int32_t layers)
    : LayerPaths(shape, layers, std::vector<std::uint64_t>(word_count(shape, layers))) {}

LayerPaths::LayerPaths(GridShape shape, std::int32_t layers, std::vector<std::uint64_t> words)
    : shape_(shape), layers_(layers), words_a_trace_(words_for(layers)), words_(std::move(words)) {
  assert(words_.size() == word_count(shape, layers));
}

std::span<const std::uint64_t> LayerPaths::trace(std::int32_t i, std::int32_t j) const {
  const std::size_t trace = static_cast<std::size_t>(i) * static_cast<std::size_t>(shape_.crosslines) + j;
  return std::span(words_).subspan(trace * words_a_trace_, words_a_trace_);
}

void LayerPaths::set(std::int32_t i, std::int32_t j, std::span<const std::int32_t> samples) {
  assert(samples.size() == static_cast<std::size_t>(layers_));
  assert(samples.front() == 0 && samples.back() == shape_.samples - 1);
  const std::size_t trace = static_cast<std::size_t>(i) * static_cast<std::size_t>(shape_.crosslines) + j;
  const auto words = std::span(words_).subspan(trace * words_a_trace_, words_a_trace_);
  for (auto& word : words) word = 0;
  for (std::size_t u = 0; u + 1 < samples.size(); ++u) {
    const std::int32_t step = samples[u + 1] - samples[u];
    assert(step == 0 || step == 1);
    words[u / kBits] |= static_cast<std::uint64_t>(step) << (u % kBits);
  }
}

void LayerPaths::get(std::int32_t i, std::int32_t j, std::span<std::int32_t> samples) const {
  const auto words = trace(i, j);
  std::int32_t sample = 0;
  for (std::size_t u = 0; u < samples.size(); ++u) {
    samples[u] = sample;
    sample += static_cast<std::int32_t>(words[u / kBits] >> (u % kBits) & 1);
  }
}

std::int32_t LayerPaths::sample_at(std::int32_t i, std::int32_t j, std::int32_t layer) const {
  const auto words = trace(i, j);
  const auto whole = static_cast<std::size_t>(layer) / kBits;
  const auto rest = static_cast<std::size_t>(layer) % kBits;
  int sample = 0;
  for (std::size_t w = 0; w < whole; ++w) sample += std::popcount(words[w]);
  if (rest != 0) sample += std::popcount(words[whole] << (kBits - rest));
  return sample;
}

std::int32_t LayerPaths::layer_of(std::int32_t i, std::int32_t j, std::int32_t k) const {
  if (k == 0) return 0;
  const auto words = trace(i, j);
  std::int32_t missing = k;  // steps still to be made
  for (std::size_t w = 0; w < words.size(); ++w) {
    const int steps = std::popcount(words[w]);
    if (steps < missing) {
      missing -= steps;
      continue;
    }
    std::uint64_t bits = words[w];
    for (; missing > 1; --missing) bits &= bits - 1;
    return static_cast<std::int32_t>(w * kBits) + std::countr_zero(bits) + 1;
  }
  return layers_ - 1;
}

bool LayerPaths::is_sound() const {
  if (layers_ < shape_.samples || shape_.samples < 1) return false;
  const auto last = static_cast<std::size_t>(layers_ - 1);  // its bit and those behind it lead nowhere
  for (std::size_t first = 0; first < words_.size(); first += words_a_trace_) {
    std::int64_t steps = 0;
    for (std::size_t w = 0; w < words_a_trace_; ++w) steps += std::popcount(words_[first + w]);
    if (steps != shape_.samples - 1) return false;
    if ((words_[first + last / kBits] >> (last % kBits)) != 0) return false;
  }
  return true;
}

}  // namespace geosis
