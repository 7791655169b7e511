#pragma once

#include "engine/base/result.h"
#include "engine/volume/formats/byte_source.h"
#include "engine/volume/formats/import.h"

namespace geosis {

/// The format of a file: what the options say, else raw when they name dims, else SEG-Y when its headers agree.
///
/// errors  malformed_input: nothing that we know.
Result<FileFormat> find_format(const ByteSource& source, const ImportOptions& options);

}  // namespace geosis
