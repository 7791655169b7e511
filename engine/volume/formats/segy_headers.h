#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/volume/formats/byte_source.h"
#include "engine/volume/formats/import.h"
#include "engine/volume/formats/sample_codec.h"

namespace geosis {

inline constexpr std::size_t kTraceHeaderBytes = 240;

/// Where the traces of a SEG-Y file lie and how they are written: what its file headers say, checked against its size.
struct SegyLayout {
  bool big_endian = true;
  int revision = 0;
  int format_code = 0;
  SampleCode code = SampleCode::ieee32;
  std::int32_t samples = 0;       ///< of each trace
  double interval_us = 0;         ///< sample interval of the binary header in microseconds; <= 0: it has none
  std::uint64_t first_trace = 0;  ///< offset in bytes
  std::uint64_t header_bytes = kTraceHeaderBytes;  ///< of each trace, extension headers included
  std::uint64_t traces = 0;
  std::string length_unit;  ///< "m", "ft" or "" (not stated)
  std::string text;
  std::vector<Warning> warnings;

  std::uint64_t sample_bytes() const { return static_cast<std::uint64_t>(samples) * bytes_per_sample(code); }
  std::uint64_t trace_bytes() const { return header_bytes + sample_bytes(); }
};

/// True when the binary header can be one of a SEG-Y file, in either byte order.
Result<bool> looks_like_segy(const ByteSource& source);

/// Reads text, binary and extended text headers of revisions 0, 1 and 2.
///
/// errors  malformed_input: not SEG-Y, no traces, cut short.  unsupported: sample format.  limit_exceeded: samples.
Result<SegyLayout> read_segy_layout(const ByteSource& source, const ImportOptions& options);

}  // namespace geosis
