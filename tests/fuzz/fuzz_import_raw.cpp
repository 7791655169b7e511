// Any bytes as a raw volume; the first eight choose the options.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "engine/volume/formats/import.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kChoices = 8;
  if (size < kChoices) return 0;
  geosis::ImportOptions options;
  options.format = geosis::FileFormat::raw;
  options.dims = {data[0], data[1], data[2]};
  if (data[3] == 255) options.dims->samples = -options.dims->samples;
  options.dtype = static_cast<geosis::SampleType>(data[4] % 8);
  options.order = static_cast<geosis::RawOrder>(data[5] % 2);
  options.byte_order = static_cast<geosis::ByteOrder>(data[6] % 3);
  if (data[7] & 1) options.null_value = data[7];
  const auto source = geosis::memory_source(std::as_bytes(std::span(data + kChoices, size - kChoices)));
  geosis::NoProgress unwatched;
  const auto volume = geosis::import_volume(*source, options, std::nullopt, unwatched);
  if (!volume) return 0;
  if (volume->samples->shape() != options.dims) std::abort();
  for (std::size_t brick = 0; brick < volume->samples->brick_count(); ++brick)
    if (!volume->samples->brick(brick)) std::abort();
  return 0;
}
