#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <span>
#include <unordered_map>

#include <sys/epoll.h>

#include "engine/base/result.h"
#include "server/net/descriptor.h"

namespace geosis::server::http {

/// epoll, level-triggered, with a number of our own instead of descriptors, which the system uses again too soon.
class Poller {
 public:
  static Result<Poller> open();

  /// Watches `descriptor` for `events` and reports them under `key`; 0 = does not watch it.
  void watch(int descriptor, std::uint64_t key, std::uint32_t events);
  /// Must come before the descriptor is closed.
  void forget(int descriptor) { watch(descriptor, 0, 0); }

  /// epoll_event::data.u64 is the key. Valid until the next call.
  std::span<const epoll_event> wait(std::chrono::milliseconds timeout);

 private:
  explicit Poller(Descriptor epoll) : epoll_(std::move(epoll)) {}

  Descriptor epoll_;
  std::unordered_map<int, std::uint32_t> watched_;  ///< events by descriptor
  std::array<epoll_event, 256> events_{};
};

}  // namespace geosis::server::http
