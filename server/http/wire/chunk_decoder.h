#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "engine/base/result.h"

namespace geosis::server::http {

/// Takes the chunked coding (RFC 9112, section 7.1) off a body, piece by piece, in constant memory.
///
/// Strict: hexadecimal digits only, CRLF only. Extensions and trailer fields are skipped, within limits of their own,
/// for they cost the sender little and us as much as data.
class ChunkDecoder {
 public:
  struct Step {
    std::size_t consumed = 0;  ///< bytes of the wire
    std::size_t produced = 0;  ///< bytes of the body
  };

  /// Decodes until the wire or the room is used up, or the body ends. errors: malformed_input, from then on always.
  Result<Step> decode(std::string_view wire, std::span<std::byte> into);

  /// The last chunk and the trailer were seen; what follows on the wire belongs to the next request.
  bool is_finished() const { return place_ == Place::end; }

 private:
  enum class Place { size, extension, size_end, data, data_return, data_end, trailer, trailer_end, end, broken };

  /// Everything between the data, one byte at a time.
  bool take(char c);
  bool take_size(char c);
  bool take_skipped(char c, Place after);
  void begin_chunk();

  Place place_ = Place::size;
  std::uint64_t left_ = 0;      ///< of this chunk's data
  int digits_ = 0;              ///< of this chunk's size
  std::size_t line_bytes_ = 0;  ///< of this trailer line
  std::size_t skipped_ = 0;     ///< bytes of extensions and trailer in the whole body
};

}  // namespace geosis::server::http
