#include "server/grpc/acceptor.h"

#include <algorithm>
#include <utility>

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/stat.h>
#include <unistd.h>

namespace geosis::server::rpc {
namespace {

constexpr int kTickMilliseconds = 250;

/// Names a socket as long as it is open; 0 for what is none.
std::uint64_t inode_of(int number) {
  struct stat status {};
  return ::fstat(number, &status) == 0 && S_ISSOCK(status.st_mode) ? status.st_ino : 0;
}

}  // namespace

Acceptor::Acceptor(Listener listener, Limits limits, Hand hand, std::function<void()> tick)
    : listener_(std::move(listener)),
      port_(listener_.port()),
      limits_(limits),
      hand_(std::move(hand)),
      tick_(std::move(tick)),
      wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      thread_([this] { run(); }) {}

void Acceptor::stop() {
  if (!thread_.joinable()) return;
  is_stopping_ = true;
  const std::uint64_t one = 1;
  static_cast<void>(::write(wake_.number(), &one, sizeof one) == 0);  // else the next tick tells it
  thread_.join();
  listener_.close();
}

void Acceptor::run() {
  auto next_tick = std::chrono::steady_clock::now();
  while (!is_stopping_) {
    pollfd events[] = {{listener_.descriptor(), POLLIN, 0}, {wake_.number(), POLLIN, 0}};
    ::poll(events, 2, kTickMilliseconds);
    if (events[0].revents != 0 && !is_stopping_) accept_all();
    if (std::chrono::steady_clock::now() < next_tick) continue;
    next_tick = std::chrono::steady_clock::now() + std::chrono::milliseconds(kTickMilliseconds);
    forget_closed();
    tick_();
  }
}

void Acceptor::accept_all() {
  for (;;) {
    Listener::Accepted accepted = listener_.accept();
    switch (accepted.outcome) {
      case Listener::Accepted::Outcome::none:
        return;
      case Listener::Accepted::Outcome::exhausted:
        ::poll(nullptr, 0, kTickMilliseconds / 10);  // the listener stays readable: no spinning
        return;
      case Listener::Accepted::Outcome::connection:
        break;
    }
    if (!has_room_for(accepted.peer)) continue;  // closed
    open_.push_back({accepted.socket.number(), inode_of(accepted.socket.number()), accepted.peer});
    count_ = open_.size();
    hand_(std::move(accepted.socket));
  }
}

/// gRPC tells nobody when it closes a socket; its number then names nothing, or another file.
void Acceptor::forget_closed() {
  std::erase_if(open_, [](const Open& one) { return one.inode == 0 || inode_of(one.number) != one.inode; });
  count_ = open_.size();
}

bool Acceptor::has_room_for(const std::string& peer) {
  const auto of_peer = [&] {
    return static_cast<std::size_t>(
        std::count_if(open_.begin(), open_.end(), [&](const Open& one) { return one.peer == peer; }));
  };
  const auto has_room = [&] { return open_.size() < limits_.connections && of_peer() < limits_.connections_per_peer; };
  if (has_room()) return true;
  forget_closed();
  return has_room();
}

}  // namespace geosis::server::rpc
