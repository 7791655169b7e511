#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <vector>

#include "engine/volume/formats/import.h"

namespace geosis {

/// A SEG-Y file built by hand, header word by header word.
class SegyBytes {
 public:
  SegyBytes(int format_code, std::int32_t samples, std::size_t bytes_per_sample, bool big_endian = true)
      : big_endian_(big_endian), sample_bytes_(static_cast<std::size_t>(samples) * bytes_per_sample), bytes_(3600) {
    set<std::int16_t>(3217, 4000).set(3221, static_cast<std::uint16_t>(samples));
    set(3225, static_cast<std::int16_t>(format_code));
  }

  /// A word of the file headers, at its byte as the standard counts.
  template <class T>
  SegyBytes& set(int byte, T value) {
    store(static_cast<std::size_t>(byte) - 1, value);
    return *this;
  }
  /// Appends a trace of zeros; its header words follow by word().
  SegyBytes& trace() {
    trace_ = bytes_.size();
    bytes_.resize(trace_ + 240 + sample_bytes_);
    return *this;
  }
  /// A word of the latest trace's header.
  template <class T = std::int32_t>
  SegyBytes& word(int byte, T value) {
    store(trace_ + static_cast<std::size_t>(byte) - 1, value);
    return *this;
  }
  /// Sample k of the latest trace, as stored.
  template <class T>
  SegyBytes& sample(std::size_t k, T stored) {
    store(trace_ + 240 + k * sizeof(T), stored);
    return *this;
  }

  std::vector<std::byte>& bytes() { return bytes_; }

 private:
  template <class T>
  void store(std::size_t offset, T value) {
    for (std::size_t b = 0; b < sizeof value; ++b) {
      const std::size_t shift = 8 * (big_endian_ ? sizeof value - 1 - b : b);
      bytes_[offset + b] = static_cast<std::byte>(static_cast<std::uint64_t>(value) >> shift);
    }
  }

  bool big_endian_;
  std::size_t sample_bytes_;
  std::size_t trace_ = 0;
  std::vector<std::byte> bytes_;
};

/// A survey of 16-bit samples whose value is 100 * i + 10 * j + k, inlines 10, 12, ..., crosslines 305, 300, ..., with
/// the numbers in the given words.
inline SegyBytes small_survey(int inlines, int crosslines, int inline_byte = 189, int crossline_byte = 193,
                              bool big_endian = true) {
  SegyBytes file(3, 3, 2, big_endian);
  for (int i = 0; i < inlines; ++i)
    for (int j = 0; j < crosslines; ++j) {
      file.trace().word(inline_byte, 10 + 2 * i).word(crossline_byte, 305 - 5 * j);
      for (int k = 0; k < 3; ++k)
        file.sample(static_cast<std::size_t>(k), static_cast<std::int16_t>(100 * i + 10 * (crosslines - 1 - j) + k));
    }
  return file;
}

inline Result<ImportedVolume> import_bytes(std::span<const std::byte> bytes, const ImportOptions& options = {},
                                           std::vector<GridCandidate>* candidates = nullptr) {
  NoProgress unwatched;
  return import_volume(*memory_source(bytes), options, std::nullopt, unwatched, candidates);
}

/// The sample at a node of a volume of one brick.
inline float sample_at(const ImportedVolume& volume, std::int32_t i, std::int32_t j, std::int32_t k) {
  const auto brick = volume.samples->brick(0);
  const GridShape extent = brick.value().extent;
  return brick.value().samples[(std::int64_t{i} * extent.crosslines + j) * extent.samples + k];
}

}  // namespace geosis
