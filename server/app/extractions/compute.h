#pragma once

#include <functional>

#include "engine/pipeline/reconstruct.h"
#include "server/app/extractions/extraction.h"
#include "server/app/volumes/volumes.h"

namespace geosis::server {

/// What reconstruct() does; tests put something else in its place.
using ReconstructFunction = std::function<Result<Reconstruction>(const ReconstructInput&, const ReconstructOptions&,
                                                                 Progress&, StageTimings*, const LevelSink&)>;

/// Keeps one encoded part until the extraction is read.
using PartWriter = std::function<Result<void>(int level, int part, std::span<const std::byte> bytes)>;

/// Volumes that an extraction reads, whoever holds them.
struct ExtractionInput {
  const VolumeSummary& volume;  ///< as the request's grid places it
  const BrickedVolume& samples;
  const DipReport* dips = nullptr;                  ///< when the grid is chosen by them and they are known already
  const StructuralGrid* grid = nullptr;             ///< when one is needed and it is there already
  const FilledVolume* filled = nullptr;             ///< when the request fills and the fill is there already
  const BrickedVolume* attribute_volume = nullptr;  ///< when the request names one
  const CurvilinearGeometry* nodes = nullptr;       ///< likewise
};

ReconstructInput reconstruct_input(const ExtractionInput& input, const ReconstructOptions& options);

struct ComputedExtraction {
  Json manifest;
  Json empty_because;  ///< null when there are levels
};

/// Computes an extraction: every part is kept, then its level shown, coarsest first.
///
/// timings   load, grid and fill are what came before; the others are set.
Result<ComputedExtraction> compute_extraction(Extraction& extraction, const ExtractionInput& input,
                                              const ReconstructOptions& options, const ReconstructFunction& reconstruct,
                                              const PartWriter& write_part, Progress& progress,
                                              ExtractionTimings& timings);

}  // namespace geosis::server
