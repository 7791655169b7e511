#pragma once

#include <functional>
#include <optional>
#include <string>

#include "engine/pipeline/describe_bodies.h"
#include "engine/pipeline/reconstruct.h"
#include "engine/volume/formats/import.h"
#include "server/documents/json_text.h"
#include "server/documents/volume_document.h"

namespace geosis::server {

/// Where a level's bytes are, relative to the manifest.
struct ManifestUrls {
  /// The whole level in one file; nullopt when there is no such file.
  std::function<std::optional<std::string>(std::size_t level, std::size_t parts)> level;
  std::function<std::string(std::size_t level, std::size_t part, std::size_t parts)> part;
  std::string bodies = "bodies";  ///< the document of the bodies
};

/// Whether lengths, areas and volumes mean something in the requested space: two axes in metres and one in milliseconds
/// make none.
bool has_lengths(const VolumeSummary& volume, const ReconstructOptions& options);

/// The manifest of the outside contract: what was asked, where the levels are and the certificate of each. A pure
/// function of volume, request and result version: no times, no absolute urls.
///
/// Lengths, areas and volumes are in the units of the requested space: null where has_lengths is false.
Json manifest_document(const VolumeSummary& volume, const ReconstructOptions& options,
                       const Reconstruction& reconstruction, const ManifestUrls& urls);
Json manifest_document(const VolumeDescription& volume, const ReconstructOptions& options,
                       const Reconstruction& reconstruction, const ManifestUrls& urls);

/// {"bodies": [...]}: what each body of the surface is, largest first.
Json bodies_document(const VolumeSummary& volume, const ReconstructOptions& options,
                     const std::vector<DescribedBody>& bodies);

/// A level's entry as it is known when the level is encoded: without distance and volume drift.
Json early_level_document(const ReconstructedLevel& level, std::size_t number, const VolumeSummary& volume,
                          const ReconstructOptions& options, const ManifestUrls& urls);

}  // namespace geosis::server
