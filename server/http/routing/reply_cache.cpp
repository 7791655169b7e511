#include "server/http/routing/reply_cache.h"

namespace geosis::server::http {
namespace {

constexpr std::chrono::minutes kLongestStay{1};

}  // namespace

void ReplyCache::keep(const std::string& name, Kept answer) {
  if (!has_room_for(answer.body->size())) return;
  const std::lock_guard lock(mutex_);
  if (const auto known = by_name_.find(name); known != by_name_.end()) forget(known->second);
  bytes_ += answer.body->size();
  entries_.push_front({name, std::move(answer), std::chrono::steady_clock::now()});
  by_name_[name] = entries_.begin();
  while (bytes_ > most_bytes_) forget(std::prev(entries_.end()));
}

std::optional<ReplyCache::Kept> ReplyCache::find(const std::string& name) {
  const std::lock_guard lock(mutex_);
  const auto known = by_name_.find(name);
  if (known == by_name_.end()) return std::nullopt;
  if (std::chrono::steady_clock::now() - known->second->since > kLongestStay) {
    forget(known->second);
    return std::nullopt;
  }
  entries_.splice(entries_.begin(), entries_, known->second);
  return known->second->answer;
}

void ReplyCache::forget(std::list<Entry>::iterator entry) {
  bytes_ -= entry->answer.body->size();
  by_name_.erase(entry->name);
  entries_.erase(entry);
}

}  // namespace geosis::server::http
