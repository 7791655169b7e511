#include "server/grpc/connections/flood_guard.h"

#include <algorithm>
#include <string_view>
#include <unordered_map>
#include <utility>

namespace geosis::server::rpc {

FloodGuard::Verdict FloodGuard::look(const std::vector<Open>& open, std::uint64_t served) {
  const std::set<std::string> names = moved(open);
  if (names.empty()) return judge(open, served, {});
  return judge(open, served, count_connections([&](const std::string& name) { return names.contains(name); }));
}

/// Those that have sent something worth a look, and those whose many calls go away without it.
std::set<std::string> FloodGuard::moved(const std::vector<Open>& open) const {
  std::set<std::string> names;
  for (const Open& one : open) {
    const auto found = known_.find(one.name);
    const Known before = found == known_.end() ? Known() : found->second;
    const bool is_moved = one.bytes > before.looked + limits_.unlooked_bytes || one.bytes < before.looked;
    if (is_moved || one.was_ended || before.held > limits_.calls.of_one_then) names.insert(one.name);
  }
  return names;
}

FloodGuard::Known FloodGuard::known(const Open& one, const ConnectionCounts* counts) const {
  const auto found = known_.find(one.name);
  Known now = found == known_.end() ? Known() : found->second;
  if (one.was_ended) {
    now.held = counts == nullptr ? 0 : counts->held;
    if (counts == nullptr) now.vain = 0;  // gRPC has let go of it
    return now;
  }
  if (one.bytes < now.looked) now = Known();  // another connection of that name
  if (counts == nullptr) return now;
  if (counts->messages != now.step.messages) now.step = {counts->messages, counts->begun, one.bytes};
  const std::uint64_t bytes = one.bytes - now.step.bytes;
  now.looked = one.bytes;
  now.held = counts->held;
  now.vain = bytes - std::min(bytes, limits_.head_bytes * (counts->begun - now.step.begun));
  return now;
}

FloodGuard::Verdict FloodGuard::judge(const std::vector<Open>& open, std::uint64_t served,
                                      const std::vector<ConnectionCounts>& counts) {
  std::unordered_map<std::string_view, const ConnectionCounts*> by_name;
  for (const ConnectionCounts& count : counts) by_name.emplace(count.connection, &count);
  std::map<std::string, Known> all;
  std::uint64_t held = 0, vain = 0;
  for (const Open& one : open) {
    const auto counted = by_name.find(one.name);
    const Known now = known(one, counted == by_name.end() ? nullptr : counted->second);
    held += now.held;
    vain += now.vain;
    all.emplace(one.name, now);
  }
  known_ = std::move(all);

  const bool has_many_calls = held > limits_.calls.of_all + served, has_many_bytes = vain > limits_.bytes.of_all;
  Verdict verdict;
  verdict.is_full = has_many_calls || has_many_bytes;
  const std::uint64_t most_calls = has_many_calls ? limits_.calls.of_one_then : limits_.calls.of_one;
  for (const Open& one : open) {
    const Known& now = known_.at(one.name);
    const std::uint64_t rightful = limits_.bytes.of_one + limits_.message_bytes * now.held;
    const std::uint64_t most_bytes = has_many_bytes ? std::min(rightful, limits_.bytes.of_one_then) : rightful;
    if (!one.was_ended && (now.held > most_calls || now.vain > most_bytes)) verdict.harmful.push_back(one.name);
  }
  return verdict;
}

}  // namespace geosis::server::rpc
