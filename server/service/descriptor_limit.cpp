#include "server/service/descriptor_limit.h"

#include <algorithm>

#include <sys/resource.h>

namespace geosis::server {

std::size_t raise_descriptor_limit() {
  constexpr rlim_t kEnough = 65'536;  // some hosts allow a billion; tables are sized by it
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return 1024;
  const rlimit raised{std::max(limit.rlim_cur, std::min(limit.rlim_max, kEnough)), limit.rlim_max};
  if (setrlimit(RLIMIT_NOFILE, &raised) == 0) limit = raised;
  return static_cast<std::size_t>(std::min(limit.rlim_cur, kEnough));
}

}  // namespace geosis::server
