#include "server/grpc/flood_guard.h"

namespace geosis::server::rpc {

FloodGuard::Verdict FloodGuard::look() const {
  const std::uint64_t of_all = held_calls();
  if (of_all <= limits_.of_one) return {};  // nobody can hold more than that
  return judge(of_all, held_calls_by_connection());
}

FloodGuard::Verdict FloodGuard::judge(std::uint64_t of_all, const std::vector<HeldCalls>& of_each) const {
  Verdict verdict;
  verdict.is_full = of_all > limits_.of_all;
  const std::uint64_t most = verdict.is_full ? limits_.of_one_then : limits_.of_one;
  for (const HeldCalls& connection : of_each) {
    if (connection.count > most) verdict.harmful.push_back(connection.connection);
  }
  return verdict;
}

}  // namespace geosis::server::rpc
