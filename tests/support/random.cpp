#include "tests/support/random.h"

#include <cstdlib>

namespace geosis::test {

std::uint64_t test_seed(std::uint64_t otherwise) {
  const char* seed = std::getenv("GEOSIS_SEED");
  return seed != nullptr ? std::strtoull(seed, nullptr, 10) : otherwise;
}

}  // namespace geosis::test
