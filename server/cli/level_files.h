#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/pipeline/reconstruct.h"
#include "engine/volume/formats/import.h"
#include "server/cli/output_folder.h"
#include "server/documents/manifest.h"

namespace geosis::server {

/// What a level is written as, beside the Draco parts that are always written.
struct FileFormats {
  bool glb = false, ply = false, obj = false, stl = false;
};

/// From "drc,glb,ply,obj,stl". errors: invalid_argument.
Result<FileFormats> parse_file_formats(std::string_view text);

/// The folder's file names: lod0.drc, or lod0.0.drc, lod0.1.drc, ... when level 0 has several parts.
ManifestUrls file_urls();

/// True for names that this program gives to files of a result: manifest.json, bodies.json, lod0.drc, lod0.1.drc,
/// lod4.ply, ...
bool is_result_file(const std::string& name);

/// What a run has made.
struct Results {
  const Reconstruction& reconstruction;
  const std::vector<DescribedBody>& bodies;
};

/// Writes all levels, bodies.json and then manifest.json.
///
/// volume   as the grid of the options places it.
Result<void> write_result(OutputFolder& folder, const VolumeSummary& volume, const ReconstructOptions& options,
                          const Results& results, FileFormats formats, Progress& progress);

}  // namespace geosis::server
