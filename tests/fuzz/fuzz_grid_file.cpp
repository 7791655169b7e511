// Any bytes as the structural grid of a small volume. Checksums are put right first, so that the fuzzer gets past them.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include <xxhash.h>

#include "engine/structure/grid_file.h"

namespace {

constexpr std::size_t kHeaderBytes = 128;

void put(std::vector<std::byte>& file, std::size_t at, std::uint64_t value) {
  std::memcpy(file.data() + at, &value, sizeof value);
}

void correct_checksums(std::vector<std::byte>& file) {
  if (file.size() < kHeaderBytes) return;
  put(file, 104, file.size());
  put(file, 112, XXH3_64bits(file.data() + kHeaderBytes, file.size() - kHeaderBytes));
  put(file, 120, 0);
  put(file, 120, XXH3_64bits(file.data(), kHeaderBytes));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto input = std::as_bytes(std::span(data, size));
  std::vector<std::byte> file(input.begin(), input.end());
  correct_checksums(file);
  constexpr geosis::GridShape kShape = {2, 3, 5};  // as write_seeds.cpp makes it
  const auto grid = geosis::read_grid_file(kShape, file);
  if (!grid) return 0;
  std::vector<std::int32_t> path(static_cast<std::size_t>(grid->paths.layers()));
  for (std::int32_t i = 0; i < kShape.inlines; ++i) {
    for (std::int32_t j = 0; j < kShape.crosslines; ++j) {
      grid->paths.get(i, j, path);
      if (path.front() != 0 || path.back() != kShape.samples - 1) __builtin_trap();
      if (grid->paths.sample_at(i, j, grid->paths.layer_of(i, j, 3)) != 3) __builtin_trap();
    }
  }
  return 0;
}
