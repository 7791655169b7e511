// Any bytes as the node positions that somebody uploads: the first byte says in which format.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "engine/volume/formats/positions.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  geosis::PositionFormat format;
  format.kind = (data[0] & 1) != 0 ? geosis::PositionFormat::Kind::pillars : geosis::PositionFormat::Kind::nodes;
  format.is_double = (data[0] & 2) != 0;
  format.big_endian = (data[0] & 4) != 0;
  constexpr geosis::GridShape kShape = {3, 2, 4};
  const auto bytes = std::as_bytes(std::span(data + 1, size - 1));
  const auto source = geosis::memory_source(bytes);
  geosis::NoProgress unwatched;
  const auto grid = geosis::import_positions(*source, kShape, format, std::nullopt, 1, unwatched);
  if (!grid) return 0;
  if (bytes.size() != geosis::position_bytes(kShape, format)) __builtin_trap();
  if (grid->summary.report.folded_share > geosis::kMostFolded) __builtin_trap();
  const geosis::Vec3d at = grid->geometry.map({2, 1, 3});
  if (!std::isfinite(at.x) || !std::isfinite(at.y) || !std::isfinite(at.z)) __builtin_trap();
  return 0;
}
