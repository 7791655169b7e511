#pragma once

#include <cstddef>

#include "engine/base/progress.h"
#include "engine/missing/axis_barycentre.h"
#include "engine/missing/file/fill_writer.h"
#include "engine/missing/gaps/bit_lines.h"
#include "engine/volume/brick_layout.h"

namespace geosis {

/// Writes a brick's records: places, values and reliabilities of its nodes by the axis barycentre. Incomplete when
/// cancelled.
///
/// nodes  to fill, one line a trace; the writer has room for as many records as the brick has of them
void fill_brick(const AxisBarycentre& barycentre, const BitLines& nodes, const BrickLayout& layout, std::size_t brick,
                FillWriter& writer, const Progress& progress);

}  // namespace geosis
