#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/app/byte_stream.h"
#include "server/app/extractions/extraction.h"

namespace geosis::server {

/// Bytes that are there already.
std::unique_ptr<ByteStream> bytes_stream(std::vector<std::byte> bytes);
/// A file, read and judged piece by piece as it is pulled. errors: not_found, unavailable.
///
/// sums      of its pieces (sums_of_file): a piece that has another one ends the stream with an error.
/// damaged   called when that happens.
Result<std::unique_ptr<ByteStream>> file_stream(const std::string& path, std::vector<std::uint64_t> sums,
                                                std::function<void()> damaged);

/// Server-sent events of an extraction, those of EventFeed. Now and then a comment, so that nobody on the way takes the
/// connection for dead.
std::unique_ptr<ByteStream> event_stream(std::shared_ptr<Extraction> extraction, std::uint64_t after);

/// multipart/mixed: the parts of every level and the manifest, as LevelFeed gives them.
///
/// abandoned   called when the stream is destroyed before its end: the reader went away.
std::unique_ptr<ByteStream> level_stream(std::shared_ptr<Extraction> extraction, std::string boundary,
                                         std::function<void()> abandoned);

/// The 16 numbers of a manifest's or canonical request's transform as header text.
std::string transform_text(const Json& transform);

}  // namespace geosis::server
