#pragma once

#include <vector>

#include <grpcpp/support/status.h>

#include "engine/base/result.h"
#include "engine/volume/formats/import.h"

namespace geosis::server::rpc {

/// An error as a status of the table in server/app/errors.h, with google.rpc details: ErrorInfo (domain "geosis", the
/// code in capitals), BadRequest when the message names a field, RetryInfo where the same call may succeed later, and
/// our own geosis.v1.Problem, which says what HTTP's problem document says.
///
/// retry_seconds   what RetryInfo says.
/// candidates      of a survey that was refused.
grpc::Status status_of(const Error& error, int retry_seconds, const std::vector<GridCandidate>& candidates = {});

}  // namespace geosis::server::rpc
