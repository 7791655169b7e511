#include "server/net/listener.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <iterator>
#include <memory>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

namespace geosis::server {
namespace {

constexpr int kBacklog = 1024;

using Addresses = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

/// A number from 0 to 65535; the resolver would take larger ones modulo 65536.
bool is_port(std::string_view text) {
  std::uint16_t port = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), port);
  return problem == std::errc{} && end == text.data() + text.size();
}

Result<Addresses> resolve(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  if (colon == std::string::npos || colon == 0 || !is_port(std::string_view(address).substr(colon + 1))) {
    return Error{ErrorCode::invalid_argument, "listen address \"" + address + "\"; expected host:port"};
  }
  std::string host = address.substr(0, colon);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  const int problem = getaddrinfo(host.c_str(), address.c_str() + colon + 1, &hints, &found);
  if (problem != 0) {
    return Error{ErrorCode::invalid_argument, "listen address \"" + address + "\": " + gai_strerror(problem)};
  }
  return Addresses(found, &freeaddrinfo);
}

/// Small packets leave at once, big answers do not pile up; a peer that is gone without a word is noticed within a
/// minute.
void set_options(int socket) {
  const auto set = [socket](int level, int name, int value) {
    ::setsockopt(socket, level, name, &value, sizeof value);
  };
  set(IPPROTO_TCP, TCP_NODELAY, 1);
  set(IPPROTO_TCP, TCP_NOTSENT_LOWAT, 256 * 1024);  // else a slow reader makes the kernel hold megabytes
  set(SOL_SOCKET, SO_KEEPALIVE, 1);
  set(IPPROTO_TCP, TCP_KEEPIDLE, 30);
  set(IPPROTO_TCP, TCP_KEEPINTVL, 10);
  set(IPPROTO_TCP, TCP_KEEPCNT, 3);
  set(IPPROTO_TCP, TCP_USER_TIMEOUT, 60'000);
}

Descriptor open_null() {
  return Descriptor(::open("/dev/null", O_RDONLY | O_CLOEXEC));
}

std::uint16_t port_of(const sockaddr_storage& address) {
  if (address.ss_family == AF_INET6) return ntohs(reinterpret_cast<const sockaddr_in6&>(address).sin6_port);
  return ntohs(reinterpret_cast<const sockaddr_in&>(address).sin_port);
}

std::string host_of(sockaddr_storage address, socklen_t length) {
  if (address.ss_family == AF_INET6) {
    auto& bytes = reinterpret_cast<sockaddr_in6&>(address).sin6_addr.s6_addr;
    const bool is_mapped = IN6_IS_ADDR_V4MAPPED(&reinterpret_cast<sockaddr_in6&>(address).sin6_addr);
    if (!is_mapped) std::fill(std::begin(bytes) + 8, std::end(bytes), std::uint8_t{0});
  }
  char host[NI_MAXHOST] = "";
  const auto* generic = reinterpret_cast<const sockaddr*>(&address);
  if (getnameinfo(generic, length, host, sizeof host, nullptr, 0, NI_NUMERICHOST) != 0) return "unknown";
  return host;
}

}  // namespace

Result<Listener> Listener::open(const std::string& address) {
  auto addresses = resolve(address);
  if (!addresses) return std::move(addresses).error();
  const addrinfo& first = **addresses;
  Descriptor socket(::socket(first.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const int yes = 1;
  const bool listens =
      socket.is_open() && setsockopt(socket.number(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) == 0 &&
      ::bind(socket.number(), first.ai_addr, first.ai_addrlen) == 0 && ::listen(socket.number(), kBacklog) == 0;
  if (!listens) return Error{ErrorCode::unavailable, "cannot listen at " + address + ": " + std::strerror(errno)};
  sockaddr_storage bound{};
  socklen_t length = sizeof bound;
  ::getsockname(socket.number(), reinterpret_cast<sockaddr*>(&bound), &length);
  return Listener(std::move(socket), port_of(bound));
}

Listener::Listener(Descriptor socket, std::uint16_t port)
    : socket_(std::move(socket)), reserve_(open_null()), port_(port) {}

Listener::Accepted Listener::accept() {
  for (;;) {
    sockaddr_storage address{};
    socklen_t length = sizeof address;
    Descriptor socket(
        ::accept4(socket_.number(), reinterpret_cast<sockaddr*>(&address), &length, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (socket.is_open()) {
      set_options(socket.number());
      return {Accepted::Outcome::connection, std::move(socket), host_of(address, length)};
    }
    switch (errno) {
      case EAGAIN:
        return {};
      case EMFILE:
        shed_one();
        return {Accepted::Outcome::exhausted, Descriptor(), {}};
      case ENFILE:
      case ENOBUFS:
      case ENOMEM:
        return {Accepted::Outcome::exhausted, Descriptor(), {}};
      case EBADF:
      case EINVAL:
      case ENOTSOCK:
        return {};
      default:
        break;  // the waiting connection's own failure (ECONNABORTED, EPROTO, ...): on to the next one
    }
  }
}

void Listener::shed_one() {
  reserve_.close();
  Descriptor(::accept4(socket_.number(), nullptr, nullptr, SOCK_CLOEXEC));
  reserve_ = open_null();
}

}  // namespace geosis::server
