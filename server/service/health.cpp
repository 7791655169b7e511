#include "server/service/health.h"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <system_error>

namespace geosis::server {
namespace {

constexpr std::uintmax_t kLeastSpace = std::uintmax_t{256} << 20;
constexpr double kHighWater = 0.9;  // of the places in the queue
constexpr std::chrono::minutes kLongestSilence{10};

std::optional<std::string> store_problem(BlobStore& store) {
  const auto staged = store.stage();
  if (!staged) return "store: it cannot be written";
  std::error_code unknown;
  const auto space = std::filesystem::space((*staged)->path().parent_path(), unknown);
  if (unknown || space.available >= kLeastSpace) return std::nullopt;
  return "store: its disk has " + std::to_string(space.available) + " bytes left; below " +
         std::to_string(kLeastSpace) + " it counts as full";
}

std::optional<std::string> queue_problem(const JobQueueReport& report) {
  std::size_t waiting = 0;
  for (const auto& row : report.rows) waiting += row.waiting;
  if (static_cast<double>(waiting) < kHighWater * static_cast<double>(report.capacity)) return std::nullopt;
  return "queue: " + std::to_string(waiting) + " of " + std::to_string(report.capacity) + " places are taken";
}

}  // namespace

std::vector<std::string> Health::not_ready() {
  std::vector<std::string> reasons;
  const JobQueueReport report = queue_.report();
  if (is_draining_ || report.is_draining) reasons.emplace_back("draining: it is shutting down");
  if (auto problem = store_problem(store_)) reasons.push_back(*std::move(problem));
  if (auto problem = queue_problem(report)) reasons.push_back(*std::move(problem));
  return reasons;
}

std::optional<std::string> Health::not_alive() {
  const auto silence = queue_.report().longest_silence;
  if (silence < kLongestSilence) return also_ ? also_() : std::nullopt;
  return "a job has made no progress for " + std::to_string(silence.count() / 1000) + " seconds";
}

}  // namespace geosis::server
