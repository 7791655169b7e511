#include "server/grpc/connections/flood_guard.h"

#include <algorithm>
#include <string_view>
#include <unordered_map>
#include <utility>

namespace geosis::server::rpc {
namespace {

/// Nobody is ended for less, whatever the others do.
constexpr std::uint64_t kFewBytes = 256 * 1024;

std::uint64_t without(std::uint64_t all, std::uint64_t part) {
  return all - std::min(all, part);
}

}  // namespace

FloodGuard::Verdict FloodGuard::look(const std::vector<Open>& open, std::uint64_t served) {
  pass_by(open);
  if (const auto names = moved(open); !names.empty()) learn(open, names);
  if (is_too_much(sums(), served)) {  // by what may be over since it was looked at
    std::set<std::string> all;
    for (const Open& one : open) all.insert(one.name);
    learn(open, all);
  }
  return judge(open, sums(), served);
}

void FloodGuard::pass_by(const std::vector<Open>& open) {
  std::map<std::string, Known> left;
  for (const Open& one : open) {
    const auto found = known_.find(one.name);
    Known now = found != known_.end() && found->second.id == one.id ? found->second : Known{.id = one.id};
    now.still = one.bytes > now.seen ? 0 : now.still + 1;
    now.seen = std::max(now.seen, one.bytes);
    left.emplace(one.name, now);
  }
  known_ = std::move(left);
}

std::set<std::string> FloodGuard::moved(const std::vector<Open>& open) const {
  std::set<std::string> names;
  for (const Open& one : open) {
    const Known& known = known_.at(one.name);
    if (one.was_ended || known.seen > known.bytes + limits_.unlooked_bytes || leftover(known) > 0)
      names.insert(one.name);
  }
  return names;
}

void FloodGuard::learn(const std::vector<Open>& open, const std::set<std::string>& names) {
  const auto counts = count_([&](const std::string& name) { return names.contains(name); });
  std::unordered_map<std::string_view, const ConnectionCounts*> by_name;
  for (const ConnectionCounts& count : counts) by_name.emplace(count.connection, &count);
  for (const Open& one : open) {
    if (!names.contains(one.name)) continue;
    const auto counted = by_name.find(one.name);
    learn(known_.at(one.name), one, counted == by_name.end() ? nullptr : counted->second);
  }
}

void FloodGuard::learn(Known& known, const Open& one, const ConnectionCounts* counts) const {
  if (counts == nullptr) {  // gRPC does not have it yet, or has let go of it
    if (one.was_ended) known.held = known.loose = 0;
    return;
  }
  const std::uint64_t begun = without(counts->begun, known.begun);
  const std::uint64_t over = without(begun + known.held, counts->held);
  if (!one.was_ended) {
    const std::uint64_t grown = known.seen - known.bytes;
    known.loose = counts->messages == known.messages ? known.loose + without(grown, limits_.head_bytes * begun) : 0;
    known.bytes = known.seen;
  }
  known.loose = without(known.loose, limits_.message_bytes * over);
  known.messages = counts->messages;
  known.begun = counts->begun;
  known.held = counts->held;
}

std::uint64_t FloodGuard::leftover(const Known& known) const {
  return without(known.held, limits_.open_calls);
}

FloodGuard::Sums FloodGuard::sums() const {
  Sums sums;
  for (const auto& [name, known] : known_) {
    sums.leftover += leftover(known);
    sums.loose += known.loose;
  }
  return sums;
}

bool FloodGuard::is_too_much(const Sums& sums, std::uint64_t served) const {
  const std::uint64_t messages = limits_.message_bytes * std::min(served, limits_.most_messages);
  return sums.leftover > limits_.leftover_calls.of_all || sums.loose > limits_.loose_bytes.of_all + messages;
}

FloodGuard::Verdict FloodGuard::judge(const std::vector<Open>& open, const Sums& sums, std::uint64_t served) const {
  const bool has_many_calls = sums.leftover > limits_.leftover_calls.of_all;
  const bool has_many_bytes = is_too_much({0, sums.loose}, served);
  const std::uint64_t count = std::max<std::uint64_t>(open.size(), 1);
  const std::uint64_t most_calls = has_many_calls
                                       ? std::min(limits_.leftover_calls.of_one, limits_.leftover_calls.of_all / count)
                                       : limits_.leftover_calls.of_one;
  const std::uint64_t share =
      std::max(limits_.loose_bytes.of_all / count, limits_.message_bytes + limits_.message_bytes / 4);
  Verdict verdict;
  bool is_somebody_ended = false;
  for (const Open& one : open) {
    const Known& known = known_.at(one.name);
    const bool lies_still = known.loose > kFewBytes && known.still > limits_.patience;
    const bool is_harmful = leftover(known) > most_calls ||
                            known.loose > limits_.loose_bytes.of_one + limits_.message_bytes * known.held ||
                            (has_many_bytes && (known.loose > share || lies_still));
    if (is_harmful && !one.was_ended) verdict.harmful.push_back(one.name);
    is_somebody_ended = is_somebody_ended || is_harmful || one.was_ended;
  }
  verdict.is_full = is_somebody_ended && (has_many_calls || has_many_bytes);
  return verdict;
}

}  // namespace geosis::server::rpc
