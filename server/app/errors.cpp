#include "server/app/errors.h"

#include <array>
#include <cstddef>

namespace geosis::server {
namespace {

// In the order of ErrorCode, whose last code is internal. HTTP 499 is what proxies log when the client went away.
// gRPC numbers are those of google.rpc.Code.
constexpr std::array kNumbers = {
    ErrorNumbers{ErrorCode::invalid_argument, 400, 3, "Invalid argument"},
    ErrorNumbers{ErrorCode::malformed_input, 422, 3, "Malformed input"},
    ErrorNumbers{ErrorCode::unsupported, 422, 12, "Unsupported"},
    ErrorNumbers{ErrorCode::not_found, 404, 5, "Not found"},
    ErrorNumbers{ErrorCode::already_exists, 409, 6, "Already exists"},
    ErrorNumbers{ErrorCode::limit_exceeded, 413, 8, "Limit exceeded"},
    ErrorNumbers{ErrorCode::no_space, 507, 8, "No space left"},
    ErrorNumbers{ErrorCode::cancelled, 499, 1, "Cancelled"},
    ErrorNumbers{ErrorCode::deadline_exceeded, 504, 4, "Deadline exceeded"},
    ErrorNumbers{ErrorCode::unauthenticated, 401, 16, "Unauthenticated"},
    ErrorNumbers{ErrorCode::permission_denied, 403, 7, "Permission denied"},
    ErrorNumbers{ErrorCode::quota_exceeded, 429, 8, "Quota exceeded"},
    ErrorNumbers{ErrorCode::unavailable, 503, 14, "Unavailable"},
    ErrorNumbers{ErrorCode::internal, 500, 13, "Internal error"},
};

constexpr bool has_each_code_in_order() {
  for (std::size_t i = 0; i < kNumbers.size(); ++i)
    if (static_cast<std::size_t>(kNumbers[i].code) != i) return false;
  return kNumbers.back().code == ErrorCode::internal;
}
static_assert(has_each_code_in_order());

}  // namespace

const ErrorNumbers& numbers_of(ErrorCode code) {
  return kNumbers[static_cast<std::size_t>(code)];
}

}  // namespace geosis::server
