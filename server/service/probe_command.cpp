#include "server/service/probe_command.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <netdb.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

namespace geosis::server {
namespace {

constexpr std::size_t kLongestAnswer = 4096;

struct ProbeArguments {
  std::string url = "http://127.0.0.1:9464/livez";
  int timeout_seconds = 4;
};

struct Target {
  std::string host, port, path;
};

/// http://HOST[:PORT][/PATH], where HOST may be an IPv6 address in brackets. What could break out of the request's line
/// is no URL.
std::optional<Target> target_of(const std::string& url) {
  constexpr std::string_view kScheme = "http://";
  if (!url.starts_with(kScheme)) return std::nullopt;
  for (const char c : url) {
    if (static_cast<unsigned char>(c) <= ' ' || c == '\x7f') return std::nullopt;
  }
  const std::string rest = url.substr(kScheme.size());
  const std::size_t slash = std::min(rest.find('/'), rest.size());
  std::string host = rest.substr(0, slash), port = "80";
  const std::size_t colon = host.rfind(':');
  if (colon != std::string::npos && !host.ends_with(']')) {
    port = host.substr(colon + 1);
    host.resize(colon);
  }
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  if (host.empty() || port.empty()) return std::nullopt;
  return Target{host, port, slash < rest.size() ? rest.substr(slash) : "/"};
}

/// A connected socket; closed by its owner.
class Connection {
 public:
  static Result<Connection> to(const Target& target, int timeout_seconds) {
    addrinfo hints{};
    hints.ai_socktype = SOCK_STREAM;
    addrinfo* found = nullptr;
    const int problem = getaddrinfo(target.host.c_str(), target.port.c_str(), &hints, &found);
    if (problem != 0) return Error{ErrorCode::unavailable, target.host + ": " + gai_strerror(problem)};
    const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> addresses(found, &freeaddrinfo);
    Connection connection(::socket(found->ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0));
    const timeval limit{timeout_seconds, 0};
    ::setsockopt(connection.socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    ::setsockopt(connection.socket_, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);  // bounds connect() as well
    if (::connect(connection.socket_, found->ai_addr, found->ai_addrlen) != 0) return failed("cannot connect");
    return connection;
  }

  /// The first bytes of the answer, until its end or kLongestAnswer.
  Result<std::string> ask(const std::string& request) {
    if (::send(socket_, request.data(), request.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(request.size())) {
      return failed("cannot send");
    }
    std::string said;
    char piece[1024];
    while (said.size() < kLongestAnswer) {
      const ssize_t count = ::recv(socket_, piece, sizeof piece, 0);
      if (count < 0) return failed("no answer");
      if (count == 0) break;
      said.append(piece, static_cast<std::size_t>(count));
    }
    return said;
  }

  Connection(Connection&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}
  Connection& operator=(Connection&&) = delete;
  ~Connection() {
    if (socket_ >= 0) ::close(socket_);
  }

 private:
  explicit Connection(int socket) : socket_(socket) {}
  static Error failed(const char* what) {
    return {ErrorCode::unavailable, std::string(what) + ": " + std::strerror(errno)};
  }
  int socket_ = -1;
};

Result<void> probe(const ProbeArguments& arguments) {
  const auto target = target_of(arguments.url);
  if (!target) return Error{ErrorCode::invalid_argument, "\"" + arguments.url + "\": expected http://HOST:PORT/PATH"};
  auto connection = Connection::to(*target, arguments.timeout_seconds);
  if (!connection) return std::move(connection).error();
  const std::string host = target->host.find(':') == std::string::npos ? target->host : "[" + target->host + "]";
  const auto said =
      connection->ask("GET " + target->path + " HTTP/1.1\r\nHost: " + host + "\r\nConnection: close\r\n\r\n");
  if (!said) return said.error();
  const bool is_good = said->starts_with("HTTP/1.1 2") || said->starts_with("HTTP/1.0 2");
  if (is_good) return {};
  const std::size_t body = said->find("\r\n\r\n");
  return Error{ErrorCode::unavailable,
               said->substr(0, said->find("\r\n")) + (body == std::string::npos ? "" : ": " + said->substr(body + 4))};
}

}  // namespace

Command add_probe_command(CLI::App& app) {
  auto& command = *app.add_subcommand("probe", "Ask a server whether it is well: exit status 0 when it answers 2xx");
  auto arguments = std::make_shared<ProbeArguments>();
  command.add_option("URL", arguments->url, "what to ask, over plain HTTP")->capture_default_str();
  command.add_option("--timeout-seconds", arguments->timeout_seconds, "for connecting, and for each read")
      ->check(CLI::Range(1, 60))
      ->capture_default_str();
  return [arguments] { return probe(*arguments); };
}

}  // namespace geosis::server
