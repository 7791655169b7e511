#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "engine/base/result.h"
#include "server/http/connections/suspended.h"
#include "server/http/wire/reply_writer.h"
#include "server/net/descriptor.h"

namespace geosis::server::http {

/// What other threads tell the loop about one of its connections. Neither: what it waits for may be there.
struct Letter {
  std::uint64_t connection = 0;
  std::unique_ptr<ReplyWriter> answer;
  std::unique_ptr<Suspended> suspended;
};

/// The loop's letter box: any thread posts, the loop's thread sleeps on the descriptor and takes. Shared, so that a
/// stream's bell that rings late still finds it.
class Mailbox {
 public:
  static Result<std::shared_ptr<Mailbox>> open();

  /// After close() the letter is thrown away.
  void post(Letter letter);
  /// Wakes the loop without a letter.
  void wake();
  std::vector<Letter> take();
  void close();
  int descriptor() const { return event_.number(); }

 private:
  explicit Mailbox(Descriptor event) : event_(std::move(event)) {}

  Descriptor event_;
  std::mutex mutex_;
  std::vector<Letter> letters_;
  bool is_closed_ = false;
};

}  // namespace geosis::server::http
