// Any bytes as the node file of a small volume. Checksums are put right first, so that the fuzzer gets past them.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <vector>

#include <xxhash.h>

#include "engine/volume/node_file.h"

namespace {

constexpr std::size_t kHeaderBytes = 168;

void put(std::vector<std::byte>& file, std::size_t at, std::uint64_t value) {
  std::memcpy(file.data() + at, &value, sizeof value);
}

void correct_checksums(std::vector<std::byte>& file) {
  if (file.size() < kHeaderBytes) return;
  put(file, 144, file.size());
  put(file, 152, XXH3_64bits(file.data() + kHeaderBytes, file.size() - kHeaderBytes));
  put(file, 160, 0);
  put(file, 160, XXH3_64bits(file.data(), kHeaderBytes));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto input = std::as_bytes(std::span(data, size));
  const auto file = std::make_shared<std::vector<std::byte>>(input.begin(), input.end());
  correct_checksums(*file);
  const auto grid = geosis::read_node_file({3, 2, 4}, *file, file);  // as write_seeds.cpp makes it
  if (!grid) return 0;
  if (grid->summary.digest.size() != 64 || !(grid->summary.report.folded_share <= 1)) __builtin_trap();
  const geosis::Vec3d at = grid->geometry.map({1.5, 0.25, 2.75});
  if (!std::isfinite(at.x) || !std::isfinite(at.y) || !std::isfinite(at.z)) __builtin_trap();
  return 0;
}
