#include "server/http/target_matcher.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <string_view>

#include <httplib.h>

namespace geosis::server::http {
namespace {

/// A request in memory; what is written to it disappears.
class MemoryStream final : public httplib::Stream {
 public:
  explicit MemoryStream(std::string_view request) : left_(request) {}

  bool is_readable() const override { return !left_.empty(); }
  bool is_writable() const override { return true; }
  ssize_t read(char* into, std::size_t size) override {
    const std::size_t count = std::min(size, left_.size());
    std::memcpy(into, left_.data(), count);
    left_.remove_prefix(count);
    return static_cast<ssize_t>(count);
  }
  ssize_t write(const char*, std::size_t size) override { return static_cast<ssize_t>(size); }
  void get_remote_ip_and_port(std::string& ip, int& port) const override {
    ip.clear();
    port = 0;
  }
  void get_local_ip_and_port(std::string& ip, int& port) const override { get_remote_ip_and_port(ip, port); }
  socket_t socket() const override { return INVALID_SOCKET; }

 private:
  std::string_view left_;
};

bool is_control(char c) {
  return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
}

/// Where this thread's match is noted: the library hands its handlers nothing of ours.
thread_local TargetMatcher::Match* current_match = nullptr;

}  // namespace

class TargetMatcher::PatternServer final : public httplib::Server {
 public:
  void add(const std::string& pattern, std::size_t number) {
    Get(pattern, [number](const httplib::Request& request, httplib::Response&) {
      current_match->pattern = number;
      for (std::size_t i = 1; i < request.matches.size(); ++i) current_match->captures.push_back(request.matches[i]);
    });
  }

  bool run(const std::string& target, Match& match) {
    const std::string request = "GET " + target + " HTTP/1.1\r\nHost: here\r\n\r\n";
    MemoryStream stream(request);
    bool closes = true, is_decoded = false;
    current_match = &match;
    const bool is_answered = process_request(stream, true, closes, [&](httplib::Request& decoded) {
      is_decoded = true;
      match.path = decoded.path;
      match.query = decoded.params;
    });
    current_match = nullptr;
    return is_answered && is_decoded;
  }
};

TargetMatcher::TargetMatcher() : server_(std::make_unique<PatternServer>()) {}
TargetMatcher::TargetMatcher(TargetMatcher&&) noexcept = default;
TargetMatcher& TargetMatcher::operator=(TargetMatcher&&) noexcept = default;
TargetMatcher::~TargetMatcher() = default;

void TargetMatcher::add(const std::string& pattern) noexcept {
  server_->add(pattern, count_++);
}

std::optional<TargetMatcher::Match> TargetMatcher::match(const std::string& target) const {
  Match match;
  try {
    if (!server_->run(target, match)) return std::nullopt;
  } catch (const std::exception&) {
    return std::nullopt;
  }
  if (std::any_of(match.path.begin(), match.path.end(), is_control)) return std::nullopt;
  return match;
}

}  // namespace geosis::server::http
