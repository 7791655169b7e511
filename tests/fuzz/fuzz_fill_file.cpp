// Any bytes as the fill file of a small volume. Checksums are put right first, so that the fuzzer gets past them.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <xxhash.h>

#include "engine/missing/file/fill_format.h"
#include "engine/missing/file/fill_image.h"
#include "engine/volume/brick_file.h"

namespace {

constexpr std::size_t kHeaderBytes = 72;

// As write_seeds.cpp makes it: two bricks, every seventh sample missing.
const geosis::BrickedVolume& volume() {
  static const auto made = [] {
    std::vector<float> samples(3 * 2 * 66);
    for (std::size_t n = 0; n < samples.size(); ++n)
      samples[n] = n % 7 == 3 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(n);
    return geosis::make_bricked_volume({3, 2, 66}, samples);
  }();
  return *made;
}

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
  put(file, 24, geosis::index_checksum(volume()));
  put(file, 48, file.size());
  const geosis::FillFilePlan plan = geosis::plan_fill_file(volume().shape(), 0);
  if (file.size() >= plan.records_at) {
    for (std::size_t brick = 0; brick < volume().brick_count(); ++brick) {
      const std::size_t entry = plan.summaries_at + brick * sizeof(geosis::StoredFill);
      const std::size_t room = (file.size() - plan.records_at) / sizeof(geosis::FilledSample);
      const auto count = word_at<std::uint32_t>(file, entry + 12);
      const auto first = word_at<std::uint64_t>(file, entry + 16);
      if (first <= room && count <= room - first)
        put(file, entry + 24,
            XXH3_64bits(file.data() + plan.records_at + first * sizeof(geosis::FilledSample),
                        count * sizeof(geosis::FilledSample)));
    }
    const std::size_t end = plan.block_ranges_at + volume().brick_count() * geosis::kFillBlockBytes;
    put(file, 56, XXH3_64bits(file.data() + plan.summaries_at, end - plan.summaries_at));
  }
  put(file, 64, 0);
  put(file, 64, XXH3_64bits(file.data(), kHeaderBytes));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto input = std::as_bytes(std::span(data, size));
  const auto file = std::make_shared<std::vector<std::byte>>(input.begin(), input.end());
  correct_checksums(*file);
  const auto plan = geosis::read_fill_file(volume(), *file);
  if (!plan) return 0;
  const geosis::FillImage filled(volume(), file, *file, *plan);
  float sum = 0;
  for (std::size_t brick = 0; brick < filled.brick_count(); ++brick) {
    sum += filled.summary(brick).range.min + filled.block_ranges(brick).back().max;
    const auto view = filled.brick(brick);
    if (view) sum += view->samples[view->extent.count() - 1];
  }
  volatile float used = sum;
  static_cast<void>(used);
  return 0;
}
