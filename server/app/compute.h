#pragma once

#include <functional>

#include "engine/pipeline/reconstruct.h"
#include "server/app/extraction.h"
#include "server/app/volumes.h"

namespace geosis::server {

/// What reconstruct() does; tests put something else in its place.
using ReconstructFunction = std::function<Result<Reconstruction>(
    const BrickedVolume&, const GridGeometry&, const ReconstructOptions&, Progress&, StageTimings*, const LevelSink&)>;

/// Keeps one encoded part until the extraction is read.
using PartWriter = std::function<Result<void>(int level, int part, std::span<const std::byte> bytes)>;

/// Computes an extraction: every part is kept, then its level shown, coarsest first; the manifest is returned.
///
/// load_seconds   what opening the volume took.
Result<Json> compute_extraction(Extraction& extraction, const VolumeSummary& volume, const BrickedVolume& samples,
                                const ReconstructOptions& options, const ReconstructFunction& reconstruct,
                                const PartWriter& write_part, Progress& progress, ExtractionTimings& timings);

}  // namespace geosis::server
