#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <utility>

#include "server/http/routing/exchange.h"
#include "server/http/wire/reply_head.h"

namespace geosis::server::http {

/// A request whose answer is pending, and all that is needed to write it once it is there.
struct Suspended {
  /// reply   pending; its on_written is told when nobody takes the answer.
  Suspended(Request from, const ReplyForm& as, Reply reply)
      : request(std::move(from)),
        form(as),
        pending(std::move(reply.pending)),
        abandoned_(std::move(reply.on_written)) {}
  Suspended(const Suspended&) = delete;
  Suspended& operator=(const Suspended&) = delete;
  ~Suspended() {
    if (abandoned_) abandoned_(0, false);
  }
  /// From now on its answer tells of the request.
  void set_resumed() { abandoned_ = nullptr; }

  const Request request;
  const ReplyForm form;
  const std::unique_ptr<PendingReply> pending;

 private:
  std::function<void(std::uint64_t, bool)> abandoned_;
};

}  // namespace geosis::server::http
