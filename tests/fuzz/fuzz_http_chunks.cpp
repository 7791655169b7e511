// Any bytes as a chunked body: decoded whole and in the pieces that the first byte chooses, with the same outcome.

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "server/http/wire/chunk_decoder.h"

namespace {

struct Outcome {
  bool is_valid = true, is_finished = false;
  std::string body;
  std::size_t consumed = 0;
  bool operator==(const Outcome&) const = default;
};

Outcome decode(std::string_view wire, std::size_t piece) {
  geosis::server::http::ChunkDecoder decoder;
  Outcome outcome;
  std::array<std::byte, 64> room;
  while (outcome.consumed < wire.size() && !decoder.is_finished()) {
    const auto step = decoder.decode(wire.substr(outcome.consumed, piece), room);
    if (!step) return {.is_valid = false, .is_finished = false, .body = {}, .consumed = 0};
    outcome.consumed += step->consumed;
    outcome.body.append(reinterpret_cast<const char*>(room.data()), step->produced);
  }
  outcome.is_finished = decoder.is_finished();
  return outcome;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view wire(reinterpret_cast<const char*>(data + 1), size - 1);
  if (decode(wire, wire.size() + 1) != decode(wire, std::size_t{data[0]} % 32 + 1)) std::abort();
  return 0;
}
