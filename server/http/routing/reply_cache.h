#pragma once

#include <chrono>
#include <cstddef>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "server/http/routing/exchange.h"

namespace geosis::server::http {

/// Good answers that never change, in memory, the least recently used ones forgotten first. Whether what they tell of
/// still exists is the finder's to know. Any thread may call any member.
class ReplyCache {
 public:
  /// bytes   of all bodies. An answer of more than an eighth of it is not kept.
  explicit ReplyCache(std::size_t bytes) : most_bytes_(bytes) {}

  struct Kept {
    std::vector<std::pair<std::string, std::string>> headers;
    std::shared_ptr<const std::string> body;
  };
  bool has_room_for(std::uint64_t bytes) const { return bytes <= most_bytes_ / 8; }
  void keep(const std::string& name, Kept answer);
  /// Nothing as well after a minute: then whoever makes it looks at the store again, which so learns of its use.
  std::optional<Kept> find(const std::string& name);

 private:
  struct Entry {
    std::string name;
    Kept answer;
    std::chrono::steady_clock::time_point since;
  };
  void forget(std::list<Entry>::iterator entry);

  const std::size_t most_bytes_;
  std::mutex mutex_;
  std::list<Entry> entries_;  ///< most recently used first
  std::unordered_map<std::string, std::list<Entry>::iterator> by_name_;
  std::size_t bytes_ = 0;
};

}  // namespace geosis::server::http
