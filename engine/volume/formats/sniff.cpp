#include "engine/volume/formats/sniff.h"

#include <string>

#include "engine/volume/formats/segy_headers.h"

namespace geosis {

Result<FileFormat> find_format(const ByteSource& source, const ImportOptions& options) {
  if (options.format != FileFormat::automatic) return options.format;
  if (options.dims) return FileFormat::raw;
  const auto segy = looks_like_segy(source);
  if (!segy) return segy.error();
  if (*segy || options.sample_format) return FileFormat::segy;
  return Error{
      ErrorCode::malformed_input,
      std::to_string(source.size()) +
          " bytes of an unknown format: no SEG-Y file headers (sample format at byte 3225), and raw files need "
          "dims"};
}

}  // namespace geosis
