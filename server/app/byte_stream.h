#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>

#include "engine/base/result.h"

namespace geosis::server {

/// Bytes of an answer that are pulled as fast as the reader takes them, and that may not exist yet.
///
/// One thread pulls. Destroying the stream before its end means that the reader went away.
class ByteStream {
 public:
  struct Pulled {
    enum class State {
      data,  ///< `count` bytes were written
      wait,  ///< nothing yet: the bell given to on_ready() will ring
      end,
    };
    State state = State::end;
    std::size_t count = 0;
  };

  virtual ~ByteStream() = default;
  /// Never blocks on work that is still going on (a file may be read). An error ends the stream: the connection breaks.
  virtual Result<Pulled> pull(std::span<std::byte> into) = 0;
  /// bell   called from any thread after a pull that said wait, when there may be more. Replaces an earlier one.
  virtual void on_ready(std::function<void()> bell) = 0;
  /// What may be said from time to time while nothing is there, so that nobody on the way takes the connection for
  /// dead.
  virtual std::string_view idle_text() const { return {}; }
};

}  // namespace geosis::server
