#pragma once

#include <cstddef>
#include <span>

#include "engine/base/result.h"

namespace geosis::server {

/// The body of an upload, pulled by its handler on a thread of its own. errors: malformed_input (framing, cut short),
/// limit_exceeded (over the limit), deadline_exceeded (slower than the minimum rate), cancelled (its sender left).
class BodyReader {
 public:
  virtual ~BodyReader() = default;
  /// Up to into.size() bytes; 0 at the end.
  virtual Result<std::size_t> read(std::span<std::byte> into) = 0;
};

/// Whether there is more of a body; takes a byte of it if so. errors: those of the body.
inline Result<bool> goes_on(BodyReader& body) {
  std::byte more{};
  const auto count = body.read(std::span(&more, 1));
  if (!count) return count.error();
  return *count > 0;
}

/// A body whose sender may have stated a digest of it.
class CheckedBody : public BodyReader {
 public:
  /// Reads what nobody has read yet, and compares. errors: those of the body; invalid_argument: it is another body.
  virtual Result<void> check() = 0;
};

}  // namespace geosis::server
