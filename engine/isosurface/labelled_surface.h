#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/isosurface/extract.h"
#include "engine/mesh/indexed_mesh.h"
#include "engine/volume/bricks.h"
#include "engine/volume/grid.h"

namespace geosis {

/// Of a body's samples; a node where the domain only touches itself counts for one of its bodies.
struct BodySamples {
  struct Amplitude {
    double mean = 0;
    float min = 0, max = 0;
  };
  std::int64_t voxels = 0;               ///< nodes of the domain in the body; 0 for one that lies between nodes
  std::optional<Amplitude> amplitude{};  ///< when asked for, and voxels > 0
};

/// The surface of a range with the bodies that it bounds: connected components of the solid {low <= f <= high}, each
/// one outer surface and those of its cavities.
///
/// Bodies are numbered 0, 1, 2, ... by falling volume_voxels, then by lowest vertex.
struct LabelledSurface {
  IndexedMesh mesh;                                     ///< that of extract_body, byte for byte
  std::vector<std::uint32_t> body;                      ///< (n) the body that the vertex bounds
  std::vector<BodySamples> samples;                     ///< [body]
  std::vector<double> volume_voxels;                    ///< [body] enclosed by its surfaces, in index units; exact.
                                                        ///< Without cap nothing is enclosed: samples' voxels
  std::vector<std::optional<std::uint32_t>> seed_body;  ///< as LabelOptions::seeds; none outside the solid
};

struct LabelOptions {
  bool amplitudes = false;         ///< read every sample in range, also in bricks that hold no surface
  std::vector<GridIndex> seeds{};  ///< nodes whose bodies are wanted
  /// Which of `count` nodes (at most 64) of a row, from k on, are samples to be counted, as bits: where several nodes
  /// are the same sample, one of them. Empty: all. Called from several threads at once.
  std::function<std::uint64_t(std::int32_t i, std::int32_t j, std::int32_t k, int count)> counted{};
};

/// extract_body, with labels.
///
/// returns  With cap every body has vertices; without, one that fills its piece of the domain has none and comes last
///          among those of its size. Nodes in range without a cell of the domain around them are in no body.
///          The same labels for any number of threads.
/// errors   those of extract_body; limit_exceeded also when the solid's pieces cannot be counted.
/// cost     that of extract_body and a fifth to two fifths more; 4 bytes a vertex, 10 KiB a brick that holds surface,
///          and O(runs on the layers that bricks share). Bricks wholly in range are read for amplitudes only.
Result<LabelledSurface> extract_labelled_body(const BrickedVolume& volume, IsoRange range,
                                              const ExtractOptions& options, const LabelOptions& labels,
                                              Progress& progress);

}  // namespace geosis
