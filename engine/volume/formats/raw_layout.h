#pragma once

#include <cstdint>

#include "engine/volume/formats/sample_codec.h"
#include "engine/volume/grid.h"

namespace geosis {

/// What a raw file holds.
struct RawLayout {
  GridShape shape;
  SampleCode code = SampleCode::ieee32;
  bool big_endian = false;
  NullValue null;

  std::uint64_t bytes_of(std::int64_t samples) const {
    return static_cast<std::uint64_t>(samples) * bytes_per_sample(code);
  }
};

}  // namespace geosis
