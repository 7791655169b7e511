#include "server/http/connections/channel.h"

#include <algorithm>
#include <array>
#include <cerrno>

#include <linux/sockios.h>
#include <sys/epoll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/uio.h>

namespace geosis::server::http {
namespace {

bool is_passing(int number) {
  return number == EAGAIN || number == EINTR;
}

}  // namespace

Channel::Moved Channel::receive(std::span<char> into) {
  const ssize_t count = ::recv(socket(), into.data(), into.size(), MSG_DONTWAIT);
  if (count > 0) return {Moved::Outcome::some, static_cast<std::size_t>(count)};
  if (count == 0) return {Moved::Outcome::ended, 0};
  return {is_passing(errno) ? Moved::Outcome::blocked : Moved::Outcome::broken, 0};
}

Channel::Moved Channel::send(std::span<const std::string_view> pieces) {
  std::array<iovec, 4> vectors{};
  const std::size_t used = std::min(pieces.size(), vectors.size());
  for (std::size_t i = 0; i < used; ++i) vectors[i] = {const_cast<char*>(pieces[i].data()), pieces[i].size()};
  msghdr message{};
  message.msg_iov = vectors.data();
  message.msg_iovlen = used;
  const ssize_t count = ::sendmsg(socket(), &message, MSG_NOSIGNAL | MSG_DONTWAIT);
  if (count >= 0) return {Moved::Outcome::some, static_cast<std::size_t>(count)};
  return {is_passing(errno) ? Moved::Outcome::blocked : Moved::Outcome::broken, 0};
}

void Channel::end() {
  ::shutdown(socket(), SHUT_WR);
}

std::uint32_t Channel::read_event() const {
  return EPOLLIN;
}

std::uint32_t Channel::write_event() const {
  return EPOLLOUT;
}

void Channel::wake_at(std::size_t bytes) {
  const int least = static_cast<int>(std::min<std::size_t>(bytes, 1 << 20));
  ::setsockopt(socket_.number(), SOL_SOCKET, SO_RCVLOWAT, &least, sizeof least);
}

void Channel::interrupt() {
  ::shutdown(socket(), SHUT_RDWR);
}

void Channel::forget_unsent() {
  const struct linger at_once { .l_onoff = 1, .l_linger = 0 };
  ::setsockopt(socket(), SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
}

std::uint64_t Channel::unsent() const {
  int queued = 0;
  ::ioctl(socket(), SIOCOUTQ, &queued);
  return static_cast<std::uint64_t>(std::max(queued, 0));
}

}  // namespace geosis::server::http
