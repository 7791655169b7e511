#include "tests/server/http/raw_client.h"

#include <array>
#include <cstdlib>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

namespace geosis::server::http {
namespace {

constexpr int kLongestWaitMilliseconds = 10'000;

}  // namespace

RawClient::RawClient(std::uint16_t port, int receive_bytes) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
  if (receive_bytes > 0) {
    ::setsockopt(socket_.number(), SOL_SOCKET, SO_RCVBUF, &receive_bytes, sizeof receive_bytes);
  }
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(socket_.number(), reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) socket_.close();
}

bool RawClient::send(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket_.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

bool RawClient::receive_some() {
  if (!socket_.is_open()) return false;
  pollfd readable{socket_.number(), POLLIN, 0};
  if (::poll(&readable, 1, kLongestWaitMilliseconds) != 1) return false;
  std::array<char, 65536> piece;
  const ssize_t count = ::recv(socket_.number(), piece.data(), piece.size(), 0);
  if (count <= 0) return false;
  received_.append(piece.data(), static_cast<std::size_t>(count));
  return true;
}

std::string RawClient::read_until(std::string_view text) {
  std::size_t end = received_.find(text);
  while (end == std::string::npos && receive_some()) end = received_.find(text);
  const std::size_t count = end == std::string::npos ? received_.size() : end + text.size();
  return read_bytes(count);
}

std::string RawClient::read_head() {
  const std::string head = read_until("\r\n\r\n");
  return head.ends_with("\r\n\r\n") ? head : "";
}

std::string RawClient::read_bytes(std::size_t count) {
  while (received_.size() < count && receive_some()) continue;
  std::string bytes = received_.substr(0, count);
  received_.erase(0, bytes.size());
  return bytes;
}

std::string RawClient::read_answer() {
  const std::string head = read_head();
  return head + read_bytes(std::strtoul(header_of(head, "Content-Length").c_str(), nullptr, 10));
}

std::string RawClient::read_all() {
  while (receive_some()) continue;
  return read_bytes(received_.size());
}

bool RawClient::is_closed_within(std::chrono::milliseconds time) {
  const auto end = std::chrono::steady_clock::now() + time;
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
    if (left.count() <= 0) return false;
    pollfd readable{socket_.number(), POLLIN, 0};
    if (::poll(&readable, 1, static_cast<int>(left.count())) == 1 && !receive_some()) return true;
  }
}

void RawClient::send_no_more() {
  ::shutdown(socket_.number(), SHUT_WR);
}

int status_of(std::string_view answer) {
  constexpr std::string_view kVersion = "HTTP/1.1 ";
  if (answer.substr(0, kVersion.size()) != kVersion) return 0;
  return std::atoi(std::string(answer.substr(kVersion.size(), 3)).c_str());
}

std::string_view body_of(std::string_view answer) {
  const std::size_t end = answer.find("\r\n\r\n");
  return end == std::string_view::npos ? std::string_view() : answer.substr(end + 4);
}

std::string header_of(std::string_view answer, std::string_view name) {
  const std::string line_start = "\r\n" + std::string(name) + ": ";
  const std::size_t start = answer.substr(0, answer.find("\r\n\r\n") + 2).find(line_start);
  if (start == std::string_view::npos) return "";
  const std::size_t begin = start + line_start.size();
  return std::string(answer.substr(begin, answer.find("\r\n", begin) - begin));
}

std::string ask(std::uint16_t port, const std::string& request_line, const std::string& headers,
                const std::string& body) {
  RawClient client(port);
  client.send(request_line + " HTTP/1.1\r\nHost: here\r\nConnection: close\r\n" + headers + "\r\n" + body);
  return client.read_all();
}

}  // namespace geosis::server::http
