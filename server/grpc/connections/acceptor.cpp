#include "server/grpc/connections/acceptor.h"

#include <algorithm>
#include <utility>

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

namespace geosis::server::rpc {
namespace {

constexpr int kTickMilliseconds = 250;
constexpr int kLookMilliseconds = 20;  // a flood begins a few thousand calls in that time
constexpr int kRoomMilliseconds = 1;

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
  waiting_.clear();
  listener_.close();
}

void Acceptor::run() {
  using Clock = std::chrono::steady_clock;
  auto next_tick = Clock::now(), next_look = next_tick;
  pollfd events[] = {{wake_.number(), POLLIN, 0}, {listener_.descriptor(), POLLIN, 0}};
  while (!is_stopping_) {
    const bool has_room = hand_.has_room(), is_taking = has_room && !is_full_;
    events[1].revents = 0;
    ::poll(events, is_taking ? 2 : 1,
           !has_room                    ? kRoomMilliseconds
           : open_.empty() && !is_full_ ? kTickMilliseconds
                                        : kLookMilliseconds);
    const auto now = Clock::now();
    if ((!open_.empty() || is_full_) && now >= next_look) {
      next_look = now + std::chrono::milliseconds(kLookMilliseconds);
      look();
    }
    if (events[1].revents != 0 && !is_full_ && !is_stopping_) accept_all();
    // A listener that has broken stays readable and gives nothing: the door's own questions tell of it.
    if ((events[1].revents & (POLLERR | POLLHUP | POLLNVAL)) != 0) events[1].fd = -1;
    if (now < next_tick) continue;
    next_tick = now + std::chrono::milliseconds(kTickMilliseconds);
    forget_closed();
    tick_();
  }
}

void Acceptor::look() {
  std::vector<FloodGuard::Open> connections;
  for (const Open& one : open_) {
    if (one.socket.is_open())
      connections.push_back({one.name, one.socket.inode(), bytes_read(one.socket.number()), one.was_ended});
  }
  FloodGuard::Verdict verdict;
  try {
    verdict = look_(connections);
  } catch (...) {  // no memory: the next look may have some
  }
  is_full_ = verdict.is_full;
  end(verdict.harmful);
  hand_waiting();
}

void Acceptor::end(const std::vector<std::string>& harmful) {
  for (Open& one : open_) {
    if (one.was_ended || std::find(harmful.begin(), harmful.end(), one.name) == harmful.end()) continue;
    one.socket.reset();
    one.was_ended = true;
  }
}

bool Acceptor::has_ending(const std::string& peer) const {
  return std::any_of(open_.begin(), open_.end(),
                     [&](const Open& one) { return one.was_ended && one.peer == peer && one.socket.is_open(); });
}

/// Of two with one name nobody could tell which one counts.
bool Acceptor::is_open(const std::string& name) const {
  return std::any_of(open_.begin(), open_.end(),
                     [&](const Open& one) { return one.name == name && one.socket.is_open(); });
}

void Acceptor::hand_waiting() {
  if (is_full_) return;
  const auto now = std::chrono::steady_clock::now();
  std::erase_if(waiting_, [&](Waiting& one) {
    if (now - one.since < limits_.longest_wait && has_ending(one.peer)) return false;
    hand_.take(std::move(one.socket), one.name);
    return true;
  });
}

void Acceptor::accept_all() {
  while (hand_.has_room()) {
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
    const std::string name = connection_name(number);
    if (is_open(name)) continue;  // its client will come from another port
    const bool must_wait = has_ending(accepted.peer);
    open_.push_back({LentSocket(number), accepted.peer, name});
    count_ = open_.size();
    if (must_wait)
      waiting_.push_back({std::move(accepted.socket), accepted.peer, name, std::chrono::steady_clock::now()});
    else
      hand_.take(std::move(accepted.socket), name);
  }
}

void Acceptor::forget_closed() {
  std::erase_if(open_, [](const Open& one) { return !one.socket.is_open(); });
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
