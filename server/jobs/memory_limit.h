#pragma once

#include <cstdint>
#include <filesystem>

namespace geosis::server {

/// Memory that this process may use: the tightest limit of its control groups (version 1 or 2) up to the root, and of
/// the machine.
///
/// proc, cgroups   where the system shows them; tests put something else in their place.
std::uint64_t memory_limit(const std::filesystem::path& proc = "/proc",
                           const std::filesystem::path& cgroups = "/sys/fs/cgroup");

}  // namespace geosis::server
