#include "server/grpc/acceptor.h"

#include <algorithm>
#include <utility>

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

namespace geosis::server::rpc {
namespace {

constexpr int kTickMilliseconds = 250;
constexpr int kLookMilliseconds = 20;  // a flood begins a few thousand calls in that time

/// Names a socket as long as it is open; 0 for what is none.
std::uint64_t inode_of(int number) {
  struct stat status {};
  return ::fstat(number, &status) == 0 && S_ISSOCK(status.st_mode) ? status.st_ino : 0;
}

/// gRPC notices the end and closes the socket, which then waits for nothing: its peer does not deserve it.
void reset(int socket) {
  const linger at_once{.l_onoff = 1, .l_linger = 0};
  ::setsockopt(socket, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  ::shutdown(socket, SHUT_RDWR);
}

}  // namespace

Acceptor::Acceptor(Listener listener, Limits limits, Hand hand, Look look, std::function<void()> tick)
    : listener_(std::move(listener)),
      port_(listener_.port()),
      limits_(limits),
      hand_(std::move(hand)),
      look_(std::move(look)),
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
  pollfd events[] = {{wake_.number(), POLLIN, 0}, {listener_.descriptor(), POLLIN, 0}};
  while (!is_stopping_) {
    ::poll(events, is_full_ ? 1 : 2, open_.empty() ? kTickMilliseconds : kLookMilliseconds);
    if (!open_.empty() || is_full_) look();
    if (events[1].revents != 0 && !is_full_ && !is_stopping_) accept_all();
    // A listener that has broken stays readable and gives nothing: the door's own questions tell of it.
    if ((events[1].revents & (POLLERR | POLLHUP | POLLNVAL)) != 0) events[1].fd = -1;
    if (std::chrono::steady_clock::now() < next_tick) continue;
    next_tick = std::chrono::steady_clock::now() + std::chrono::milliseconds(kTickMilliseconds);
    forget_closed();
    tick_();
  }
}

void Acceptor::look() {
  std::vector<FloodGuard::Open> connections;
  for (const Open& one : open_) {
    if (inode_of(one.number) == one.inode) connections.push_back({one.name, bytes_read(one.number)});
  }
  FloodGuard::Verdict verdict;
  try {
    verdict = look_(connections);
  } catch (...) {  // no memory: the next look may have some
  }
  is_full_ = verdict.is_full;
  for (const Open& one : open_) {
    const bool is_harmful =
        std::find(verdict.harmful.begin(), verdict.harmful.end(), one.name) != verdict.harmful.end();
    if (is_harmful && inode_of(one.number) == one.inode) reset(one.number);
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
    const int number = accepted.socket.number();
    open_.push_back({number, inode_of(number), accepted.peer, connection_name(number)});
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
