#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace geosis {

/// One bit for each node of many parallel lines of equal length, so that the nearest marked node on a line is found 64
/// nodes at a time. Bits beyond a line's end are 0.
class BitLines {
 public:
  BitLines() = default;
  BitLines(std::size_t lines, std::int32_t length)
      : length_(length), words_((static_cast<std::size_t>(length) + 63) / 64), bits_(lines * words_) {}

  std::int32_t length() const { return length_; }
  std::size_t words() const { return words_; }
  std::span<std::uint64_t> line(std::size_t number) { return {bits_.data() + number * words_, words_}; }
  std::span<const std::uint64_t> line(std::size_t number) const { return {bits_.data() + number * words_, words_}; }
  /// The bits of a line's last word that belong to it.
  std::uint64_t last_word() const {
    return length_ % 64 == 0 ? ~std::uint64_t{0} : (std::uint64_t{1} << length_ % 64) - 1;
  }

  bool test(std::size_t number, std::int32_t node) const {
    return (line(number)[static_cast<std::size_t>(node) / 64] >> (node % 64) & 1) != 0;
  }
  /// Nodes from, from + 1, ... of a line in bits 0, 1, ...; at most 64, all of them on the line.
  std::uint64_t bits(std::size_t number, std::int32_t from, std::int32_t count) const {
    const auto words = line(number);
    const auto word = static_cast<std::size_t>(from) / 64;
    std::uint64_t found = words[word] >> from % 64;
    if (from % 64 != 0 && word + 1 < words_) found |= words[word + 1] << (64 - from % 64);
    return count == 64 ? found : found & ((std::uint64_t{1} << count) - 1);
  }
  /// Marked nodes of all lines.
  std::uint64_t count() const {
    std::uint64_t marked = 0;
    for (const std::uint64_t word : bits_) marked += static_cast<std::uint64_t>(std::popcount(word));
    return marked;
  }
  /// The nearest marked node before this one; -1 = none.
  std::int32_t before(std::size_t number, std::int32_t node) const {
    const auto bits = line(number);
    std::ptrdiff_t word = node / 64;
    std::uint64_t rest = bits[static_cast<std::size_t>(word)] & ((std::uint64_t{1} << node % 64) - 1);
    while (rest == 0)
      if (--word < 0)
        return -1;
      else
        rest = bits[static_cast<std::size_t>(word)];
    return static_cast<std::int32_t>(word * 64) + 63 - std::countl_zero(rest);
  }
  /// The nearest marked node after this one; -1 = none.
  std::int32_t after(std::size_t number, std::int32_t node) const {
    const auto bits = line(number);
    auto word = static_cast<std::size_t>(node) / 64;
    std::uint64_t rest = bits[word] & ~((std::uint64_t{2} << node % 64) - 1);
    while (rest == 0)
      if (++word == words_)
        return -1;
      else
        rest = bits[word];
    return static_cast<std::int32_t>(word * 64) + std::countr_zero(rest);
  }

 private:
  std::int32_t length_ = 0;
  std::size_t words_ = 0;
  std::vector<std::uint64_t> bits_;
};

}  // namespace geosis
