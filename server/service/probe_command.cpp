#include "server/service/probe_command.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <netdb.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include "server/service/probe_tls.h"

namespace geosis::server {
namespace {

constexpr std::size_t kLongestAnswer = 4096;

struct ProbeArguments {
  std::string url = "http://127.0.0.1:9464/livez";
  int timeout_seconds = 4;
  ProbeTrust trust;
};

struct Target {
  bool is_tls = false;
  std::string host, port, path;
};

/// http://HOST[:PORT][/PATH] or https://..., where HOST may be an IPv6 address in brackets. What could break out of the
/// request's line is no URL.
std::optional<Target> target_of(const std::string& url) {
  const bool is_tls = url.starts_with("https://");
  if (!is_tls && !url.starts_with("http://")) return std::nullopt;
  for (const char c : url) {
    if (static_cast<unsigned char>(c) <= ' ' || c == '\x7f') return std::nullopt;
  }
  const std::string rest = url.substr(url.find("//") + 2);
  const std::size_t slash = std::min(rest.find('/'), rest.size());
  std::string host = rest.substr(0, slash), port = is_tls ? "443" : "80";
  const std::size_t colon = host.rfind(':');
  if (colon != std::string::npos && !host.ends_with(']')) {
    port = host.substr(colon + 1);
    host.resize(colon);
  }
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  if (host.empty() || port.empty()) return std::nullopt;
  return Target{is_tls, host, port, slash < rest.size() ? rest.substr(slash) : "/"};
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

  static Error failed(const char* what) {
    return {ErrorCode::unavailable, std::string(what) + ": " + std::strerror(errno)};
  }

  int socket() const { return socket_; }
  bool send(const std::string& text) {
    return ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size());
  }
  /// Bytes read; 0 at the end, -1 when there are none in time.
  long receive(char* into, std::size_t capacity) { return ::recv(socket_, into, capacity, 0); }

  Connection(Connection&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}
  Connection& operator=(Connection&&) = delete;
  ~Connection() {
    if (socket_ >= 0) ::close(socket_);
  }

 private:
  explicit Connection(int socket) : socket_(socket) {}
  int socket_ = -1;
};

/// The first bytes of the answer, until its end or kLongestAnswer.
template <class Way>
Result<std::string> ask(Way& way, const std::string& request) {
  if (!way.send(request)) return Connection::failed("cannot send");
  std::string said;
  char piece[1024];
  while (said.size() < kLongestAnswer) {
    const long count = way.receive(piece, sizeof piece);
    if (count < 0) return Connection::failed("no answer");
    if (count == 0) break;
    said.append(piece, static_cast<std::size_t>(count));
  }
  return said;
}

Result<std::string> answer_of(const Target& target, const ProbeArguments& arguments) {
  auto connection = Connection::to(target, arguments.timeout_seconds);
  if (!connection) return std::move(connection).error();
  const std::string host = target.host.find(':') == std::string::npos ? target.host : "[" + target.host + "]";
  const std::string request = "GET " + target.path + " HTTP/1.1\r\nHost: " + host + "\r\nConnection: close\r\n\r\n";
  if (!target.is_tls) return ask(*connection, request);
  auto tls = ProbeTls::begin(connection->socket(), target.host, arguments.trust);
  if (!tls) return std::move(tls).error();
  return ask(*tls, request);
}

Result<void> probe(const ProbeArguments& arguments) {
  const auto target = target_of(arguments.url);
  if (!target) {
    return Error{ErrorCode::invalid_argument, "\"" + arguments.url + "\": expected http://HOST:PORT/PATH, or https://"};
  }
  const auto said = answer_of(*target, arguments);
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
  command.add_option("URL", arguments->url, "what to ask, http:// or https://")->capture_default_str();
  command.add_option("--timeout-seconds", arguments->timeout_seconds, "for connecting, and for each read")
      ->check(CLI::Range(1, 60))
      ->capture_default_str();
  auto* authorities = command.add_option("--ca", arguments->trust.authorities,
                                         "whose certificates to believe instead of the system's authorities");
  authorities->type_name("PEM");
  command.add_flag("--any-certificate", arguments->trust.any_certificate, "believe every certificate, for any name")
      ->excludes(authorities);
  return [arguments] { return probe(*arguments); };
}

}  // namespace geosis::server
