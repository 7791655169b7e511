#include "server/http/wire/chunk_decoder.h"

#include <algorithm>
#include <cstring>

#include "engine/base/hexadecimal.h"

namespace geosis::server::http {
namespace {

constexpr int kMostDigits = 15;  // fit into 60 bits
constexpr std::size_t kMostSkipped = 8 * 1024;

bool is_control(char c) {
  return (static_cast<unsigned char>(c) < 0x20 && c != '\t') || c == 0x7f;
}

}  // namespace

Result<ChunkDecoder::Step> ChunkDecoder::decode(std::string_view wire, std::span<std::byte> into) {
  Step step;
  while (step.consumed < wire.size() && place_ != Place::end) {
    if (place_ == Place::data) {
      const std::uint64_t space = std::min(wire.size() - step.consumed, into.size() - step.produced);
      const auto count = static_cast<std::size_t>(std::min(left_, space));
      if (count == 0) break;
      std::memcpy(into.data() + step.produced, wire.data() + step.consumed, count);
      step.consumed += count;
      step.produced += count;
      left_ -= count;
      if (left_ == 0) place_ = Place::data_return;
    } else if (place_ == Place::broken || !take(wire[step.consumed++])) {
      place_ = Place::broken;
      return Error{ErrorCode::malformed_input, "the body's chunked coding is broken"};
    }
  }
  return step;
}

bool ChunkDecoder::take(char c) {
  switch (place_) {
    case Place::size:
      return take_size(c);
    case Place::extension:
      return take_skipped(c, Place::size_end);
    case Place::size_end:
      begin_chunk();
      return c == '\n';
    case Place::data_return:
      place_ = Place::data_end;
      return c == '\r';
    case Place::data_end:
      place_ = Place::size;
      digits_ = 0;
      return c == '\n';
    case Place::trailer:
      return take_skipped(c, Place::trailer_end);
    case Place::trailer_end:
      place_ = line_bytes_ == 0 ? Place::end : Place::trailer;
      line_bytes_ = 0;
      return c == '\n';
    case Place::data:
    case Place::end:
    case Place::broken:
      break;
  }
  return false;
}

bool ChunkDecoder::take_size(char c) {
  if (const int digit = hexadecimal_digit(c); digit >= 0) {
    left_ = left_ * 16 + static_cast<std::uint64_t>(digit);
    return ++digits_ <= kMostDigits;
  }
  if (c != '\r' && c != ';') return false;
  place_ = c == ';' ? Place::extension : Place::size_end;
  return digits_ > 0;
}

bool ChunkDecoder::take_skipped(char c, Place after) {
  if (c == '\r') {
    place_ = after;
    return true;
  }
  ++line_bytes_;
  return !is_control(c) && ++skipped_ <= kMostSkipped;
}

void ChunkDecoder::begin_chunk() {
  place_ = left_ == 0 ? Place::trailer : Place::data;
  line_bytes_ = 0;
}

}  // namespace geosis::server::http
