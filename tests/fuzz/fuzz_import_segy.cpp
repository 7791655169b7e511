// Any bytes as a SEG-Y file, under options that the first two bytes choose.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "engine/volume/formats/import.h"

namespace {

geosis::ImportOptions options_from(std::uint8_t choice, std::uint8_t word) {
  geosis::ImportOptions options;
  options.format = geosis::FileFormat::segy;
  if (choice & 1) options.byte_order = choice & 2 ? geosis::ByteOrder::little : geosis::ByteOrder::big;
  if (choice & 4) options.duplicates = choice & 8 ? geosis::DuplicateTraces::mean : geosis::DuplicateTraces::last;
  if (choice & 16) options.zero_traces = geosis::ZeroTraces::missing;
  if (choice & 32) options.null_value = 0;
  if (choice & 64) options.inline_byte = word;
  if (choice & 128) options.crossline_width = 2;
  return options;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const geosis::ImportOptions options = options_from(data[0], data[1]);
  const auto source = geosis::memory_source(std::as_bytes(std::span(data + 2, size - 2)));
  geosis::NoProgress unwatched;
  std::vector<geosis::GridCandidate> candidates;
  const auto volume = geosis::import_volume(*source, options, std::nullopt, unwatched, &candidates);
  if (!volume) return 0;
  // What was imported must be whole and say about itself what is true.
  if (volume->samples->shape() != volume->description.shape) std::abort();
  for (std::size_t brick = 0; brick < volume->samples->brick_count(); ++brick)
    if (!volume->samples->brick(brick)) std::abort();
  return 0;
}
