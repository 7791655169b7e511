#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/volume/formats/byte_source.h"

namespace geosis {

/// Where the records of a file lie: `count` of them, `bytes` each, one after the other from offset `begin`.
struct Records {
  std::uint64_t begin = 0, bytes = 0, count = 0;
};

/// Some records that follow each other, in memory.
struct RecordBatch {
  std::uint64_t first = 0, count = 0;
  std::span<const std::byte> bytes;
};

/// What is done with records as they pass. The spans die with the call.
struct RecordVisitor {
  std::function<void(const RecordBatch&)> in_order;  ///< every batch, one after the other; may be empty
  /// Every batch once for each part, from several threads; but a part sees one batch after the other.
  std::function<Result<void>(const RecordBatch&, std::size_t part)> in_parts;
  std::size_t parts = 32;
};

/// The records of a batch that one of several parts may take as its own.
RecordBatch share_of(const RecordBatch& batch, std::size_t part, std::size_t parts);

/// Reads a file once from end to end: reading ahead, hashing and the visitor's work go side by side. Only the calling
/// thread reads, from the first byte to the last in order, so a file that still arrives may be read.
///
/// returns  SHA-256 of all bytes of the file, hexadecimal.
/// memory   two batches of 16 MiB, or two records if they are longer.
/// errors   cancelled, and those of reading and of the visitor.
Result<std::string> stream_records(const ByteSource& source, const Records& records, const RecordVisitor& visitor,
                                   int threads, Progress& progress);

}  // namespace geosis
