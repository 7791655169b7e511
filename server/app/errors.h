#pragma once

#include "engine/base/result.h"

namespace geosis::server {

/// What each kind of error is called at the two doors: one table, so that they cannot drift apart.
struct ErrorNumbers {
  ErrorCode code;
  int http_status;
  int grpc_status;
  const char* title;
};

const ErrorNumbers& numbers_of(ErrorCode code);

}  // namespace geosis::server
