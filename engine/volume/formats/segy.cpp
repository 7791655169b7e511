#include "engine/volume/formats/segy.h"

#include <utility>

#include "engine/base/parallel.h"
#include "engine/volume/brick_writer.h"
#include "engine/volume/formats/segy_describe.h"
#include "engine/volume/formats/segy_headers.h"
#include "engine/volume/formats/trace_grid.h"
#include "engine/volume/formats/trace_mover.h"

namespace geosis {
namespace {

Result<void> check_options(const ImportOptions& options, const SegyLayout& layout) {
  if (options.dims) return Error{ErrorCode::invalid_argument, "dims belongs to raw files; a SEG-Y file states its own"};
  if (layout.samples < 2)
    return Error{ErrorCode::unsupported,
                 "SEG-Y: not a volume: traces of " + std::to_string(layout.samples) + " sample"};
  return {};
}

}  // namespace

Result<ImportedVolume> import_segy(const ByteSource& source, const ImportOptions& options,
                                   const std::optional<std::filesystem::path>& brick_file, Progress& progress,
                                   std::vector<GridCandidate>* candidates) {
  const auto layout = read_segy_layout(source, options);
  if (!layout) return layout.error();
  if (auto valid = check_options(options, *layout); !valid) return std::move(valid).error();
  auto coordinates = coordinates_to_try(options);
  if (!coordinates) return std::move(coordinates).error();
  const auto found = find_grid(source, *layout, options, progress, candidates);
  if (!found) return found.error();

  const GridShape shape{found->grid.inlines.count, found->grid.crosslines.count, layout->samples};
  auto writer = BrickWriter::create(shape, brick_file);
  if (!writer) return std::move(writer).error();
  TraceMover mover(source, *layout, found->grid, options, *coordinates, *writer);
  auto digest = mover.move_all(default_threads(), progress);
  if (!digest) return std::move(digest).error();
  auto samples = std::move(*writer).finish(default_threads(), progress);
  if (!samples) return std::move(samples).error();

  ImportedVolume volume{*std::move(samples), describe_segy(*layout, *found, options, *coordinates)};
  mover.tally().describe(*volume.samples, volume.description);
  for (Warning& warning : mover.warnings()) volume.description.warnings.push_back(std::move(warning));
  volume.description.bytes = static_cast<std::int64_t>(source.size());
  volume.description.digest = *std::move(digest);
  return volume;
}

}  // namespace geosis
