#include "server/http/connections/poller.h"

#include <cerrno>
#include <cstring>
#include <string>

namespace geosis::server::http {

Result<Poller> Poller::open() {
  Descriptor epoll(::epoll_create1(EPOLL_CLOEXEC));
  if (!epoll.is_open()) return Error{ErrorCode::unavailable, std::string("epoll: ") + std::strerror(errno)};
  return Poller(std::move(epoll));
}

void Poller::watch(int descriptor, std::uint64_t key, std::uint32_t events) {
  const auto watched = watched_.find(descriptor);
  const bool is_watched = watched != watched_.end();
  if (is_watched ? watched->second == events : events == 0) return;
  epoll_event event{};
  event.events = events;
  event.data.u64 = key;
  const int action = events == 0 ? EPOLL_CTL_DEL : is_watched ? EPOLL_CTL_MOD : EPOLL_CTL_ADD;
  ::epoll_ctl(epoll_.number(), action, descriptor, &event);
  if (events == 0) {
    watched_.erase(watched);
  } else {
    watched_.insert_or_assign(descriptor, events);
  }
}

std::span<const epoll_event> Poller::wait(std::chrono::milliseconds timeout) {
  const int count = ::epoll_wait(epoll_.number(), events_.data(), static_cast<int>(events_.size()),
                                 static_cast<int>(timeout.count()));
  return std::span(events_).first(count < 0 ? 0 : static_cast<std::size_t>(count));
}

}  // namespace geosis::server::http
