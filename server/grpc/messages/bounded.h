#pragma once

#include <string>

#include "engine/base/result.h"

namespace geosis::server::rpc {

/// A number of the request, 0 being the default. errors: invalid_argument.
inline Result<int> bounded(const char* field, int number, int otherwise, int most) {
  if (number == 0) return otherwise;
  if (number >= 1 && number <= most) return number;
  return Error{ErrorCode::invalid_argument, std::string("/") + field + ": " + std::to_string(number) +
                                                "; expected a whole number from 1 to " + std::to_string(most)};
}

}  // namespace geosis::server::rpc
