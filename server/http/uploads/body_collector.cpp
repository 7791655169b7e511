#include "server/http/uploads/body_collector.h"

#include <algorithm>
#include <array>

namespace geosis::server::http {

BodyCollector::BodyCollector(const Head& head, std::size_t most_bytes)
    : is_chunked_(head.is_chunked), length_(head.content_length.value_or(0)), most_bytes_(most_bytes) {}

BodyCollector::State BodyCollector::feed(std::string& wire) {
  return is_chunked_ ? feed_chunked(wire) : feed_counted(wire);
}

BodyCollector::State BodyCollector::feed_counted(std::string& wire) {
  if (length_ > most_bytes_) return State::too_big;
  const std::size_t count = std::min(wire.size(), static_cast<std::size_t>(length_) - body_.size());
  body_.append(wire, 0, count);
  wire.erase(0, count);
  return body_.size() == length_ ? State::complete : State::incomplete;
}

BodyCollector::State BodyCollector::feed_chunked(std::string& wire) {
  std::array<std::byte, 4096> piece;
  while (!wire.empty() && !decoder_.is_finished()) {
    const auto step = decoder_.decode(wire, piece);
    if (!step) return State::broken;
    wire.erase(0, step->consumed);
    body_.append(reinterpret_cast<const char*>(piece.data()), step->produced);
    if (body_.size() > most_bytes_) return State::too_big;
  }
  return decoder_.is_finished() ? State::complete : State::incomplete;
}

}  // namespace geosis::server::http
