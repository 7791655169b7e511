#include "server/grpc/flood_guard.h"

#include <algorithm>
#include <string_view>
#include <unordered_map>
#include <utility>

namespace geosis::server::rpc {
namespace {

struct Judged {
  const std::string* name;
  std::uint64_t held, vain;  ///< calls; bytes since a message was whole
};

}  // namespace

FloodGuard::Verdict FloodGuard::look(const std::vector<Open>& open) {
  const std::uint64_t held = held_calls();
  if (held <= limits_.calls.of_one && !is_suspicious(open)) return {};  // nobody can have more than his share
  return judge(open, held, counts_by_connection());
}

bool FloodGuard::is_suspicious(const std::vector<Open>& open) const {
  return std::any_of(open.begin(), open.end(), [&](const Open& one) {
    const auto step = steps_.find(one.name);
    return one.bytes - (step == steps_.end() ? 0 : step->second.bytes) > limits_.bytes.of_one_then;
  });
}

FloodGuard::Verdict FloodGuard::judge(const std::vector<Open>& open, std::uint64_t held,
                                      const std::vector<ConnectionCounts>& counts) {
  std::unordered_map<std::string_view, const ConnectionCounts*> by_name;
  for (const ConnectionCounts& count : counts) by_name.emplace(count.connection, &count);
  std::map<std::string, Step> steps;
  std::vector<Judged> judged;
  std::uint64_t vain = 0;
  for (const Open& one : open) {
    const auto counted = by_name.find(one.name);
    if (counted == by_name.end()) continue;
    const ConnectionCounts& count = *counted->second;
    const auto before = steps_.find(one.name);
    const bool is_still =
        before != steps_.end() && before->second.messages == count.messages && before->second.bytes <= one.bytes;
    const Step step = is_still ? before->second : Step{count.messages, count.begun, one.bytes};
    const std::uint64_t bytes = one.bytes - step.bytes;
    judged.push_back({&one.name, count.held, bytes - std::min(bytes, limits_.head_bytes * (count.begun - step.begun))});
    vain += judged.back().vain;
    steps.emplace(one.name, step);
  }
  steps_ = std::move(steps);

  const bool has_many_calls = held > limits_.calls.of_all, has_many_bytes = vain > limits_.bytes.of_all;
  Verdict verdict;
  verdict.is_full = has_many_calls || has_many_bytes;
  const std::uint64_t most_calls = has_many_calls ? limits_.calls.of_one_then : limits_.calls.of_one;
  for (const Judged& one : judged) {
    const std::uint64_t most_bytes =
        has_many_bytes ? limits_.bytes.of_one_then : limits_.bytes.of_one + limits_.message_bytes * one.held;
    if (one.held > most_calls || one.vain > most_bytes) verdict.harmful.push_back(*one.name);
  }
  return verdict;
}

}  // namespace geosis::server::rpc
