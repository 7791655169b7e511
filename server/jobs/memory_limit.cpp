#include "server/jobs/memory_limit.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace geosis::server {
namespace {

constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();

std::optional<std::uint64_t> number_at_start(std::string_view text) {
  std::uint64_t number = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (problem != std::errc{}) return std::nullopt;
  return number;
}

/// The limit in a file; kNone for "max", for no file, and for anything else that is no number.
std::uint64_t limit_in(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line;
  if (!std::getline(stream, line)) return kNone;
  return number_at_start(line).value_or(kNone);
}

/// The tightest limit of a group and those above it. A container sees its own group as the root of the hierarchy, and
/// the path that /proc tells does not exist there: then the root's limit is all there is.
std::uint64_t tightest(const std::filesystem::path& root, std::string_view group, const char* file) {
  std::uint64_t limit = limit_in(root / file);
  std::filesystem::path place = root;
  for (const auto& name : std::filesystem::path(group).relative_path()) {
    place /= name;
    limit = std::min(limit, limit_in(place / file));
  }
  return limit;
}

std::uint64_t group_limit(const std::filesystem::path& proc, const std::filesystem::path& cgroups) {
  std::uint64_t limit =
      std::min(tightest(cgroups, "", "memory.max"), tightest(cgroups / "memory", "", "memory.limit_in_bytes"));
  std::ifstream groups(proc / "self" / "cgroup");
  for (std::string line; std::getline(groups, line);) {  // number:controllers:path
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    const std::string_view path = std::string_view(line).substr(second + 1);
    if (controllers == ",,") {
      limit =
          std::min({limit, tightest(cgroups, path, "memory.max"), tightest(cgroups / "unified", path, "memory.max")});
    } else if (controllers.find(",memory,") != std::string::npos) {
      limit = std::min(limit, tightest(cgroups / "memory", path, "memory.limit_in_bytes"));
    }
  }
  return limit;
}

std::uint64_t machine_memory(const std::filesystem::path& proc) {
  std::ifstream file(proc / "meminfo");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("MemTotal:")) continue;
    const auto digits = line.find_first_of("0123456789");
    if (digits == std::string::npos) break;
    return number_at_start(std::string_view(line).substr(digits)).value_or(0) * 1024;
  }
  return kNone;
}

}  // namespace

std::uint64_t memory_limit(const std::filesystem::path& proc, const std::filesystem::path& cgroups) {
  return std::min(group_limit(proc, cgroups), machine_memory(proc));
}

}  // namespace geosis::server
