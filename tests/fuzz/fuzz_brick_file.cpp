// Any bytes as a brick file. Checksums of header and index are put right first, so that the fuzzer gets past them.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <vector>

#include <xxhash.h>

#include "engine/volume/brick_format.h"
#include "engine/volume/brick_image.h"

namespace {

constexpr std::size_t kHeaderBytes = 56, kSectionBytes = 32, kChecksumAt = 48;

template <class T>
T word_at(const std::vector<std::byte>& file, std::size_t at) {
  T value;
  std::memcpy(&value, file.data() + at, sizeof value);
  return value;
}

void put(std::vector<std::byte>& file, std::size_t at, std::uint64_t value) {
  std::memcpy(file.data() + at, &value, sizeof value);
}

void correct_checksums(std::vector<std::byte>& file) {
  if (file.size() < kHeaderBytes) return;
  const std::size_t sections = word_at<std::uint32_t>(file, 12);
  if (sections > (file.size() - kHeaderBytes) / kSectionBytes) return;
  for (std::size_t s = 0; s < sections; ++s) {
    const std::size_t entry = kHeaderBytes + s * kSectionBytes;
    const auto offset = word_at<std::uint64_t>(file, entry + 8), bytes = word_at<std::uint64_t>(file, entry + 16);
    if (offset <= file.size() && bytes <= file.size() - offset)
      put(file, entry + 24, XXH3_64bits(file.data() + offset, bytes));
  }
  put(file, 40, file.size());
  put(file, kChecksumAt, 0);
  put(file, kChecksumAt, XXH3_64bits(file.data(), kHeaderBytes + sections * kSectionBytes));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto input = std::as_bytes(std::span(data, size));
  const auto file = std::make_shared<std::vector<std::byte>>(input.begin(), input.end());
  correct_checksums(*file);
  const auto plan = geosis::read_brick_header(*file);
  if (!plan) return 0;
  const geosis::BrickImage volume(file, *file, *plan);
  float sum = 0;
  for (std::size_t brick = 0; brick < volume.brick_count(); ++brick) {
    sum += volume.summary(brick).range.min + volume.block_ranges(brick).back().max;
    const auto view = volume.brick(brick);
    if (view) sum += view->samples[view->extent.count() - 1];
  }
  volatile float used = sum;
  static_cast<void>(used);
  return 0;
}
