#include "engine/volume/formats/import.h"

#include "engine/volume/formats/raw.h"
#include "engine/volume/formats/segy.h"
#include "engine/volume/formats/sniff.h"

namespace geosis {

Result<ImportedVolume> import_volume(const ByteSource& source, const ImportOptions& options,
                                     const std::optional<std::filesystem::path>& brick_file, Progress& progress,
                                     std::vector<GridCandidate>* candidates) {
  const auto format = find_format(source, options);
  if (!format) return format.error();
  if (*format == FileFormat::raw) return import_raw(source, options, brick_file, progress);
  return import_segy(source, options, brick_file, progress, candidates);
}

}  // namespace geosis
