#include "server/grpc/messages/error_status.h"

#include <algorithm>
#include <cctype>
#include <string>

#include <geosis/v1/volume.pb.h>
#include <google_rpc.pb.h>

#include "server/app/errors.h"
#include "server/app/problem.h"
#include "server/documents/volume_document.h"
#include "server/grpc/messages/message_codec.h"

namespace geosis::server::rpc {
namespace {

// Trailing metadata of more than 8 KiB are refused by clients.
constexpr std::size_t kLongestDetail = 768;
constexpr std::size_t kMostCandidates = 24;

std::string capitals(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
  return text;
}

bool may_succeed_later(ErrorCode code) {
  return code == ErrorCode::unavailable || code == ErrorCode::quota_exceeded;
}

v1::Problem problem_of(const Error& error, const std::vector<GridCandidate>& candidates) {
  Json document = problem_document(error);
  if (!candidates.empty()) {
    const std::size_t count = std::min(candidates.size(), kMostCandidates);
    document["candidates"] = candidates_document({candidates.begin(), candidates.begin() + count});
  }
  v1::Problem problem;
  set_message(problem, document);
  problem.set_detail(shortened(problem.detail(), kLongestDetail));
  problem.set_pointer(shortened(problem.pointer(), kLongestDetail));
  return problem;
}

}  // namespace

grpc::Status status_of(const Error& error, int retry_seconds, const std::vector<GridCandidate>& candidates) {
  const v1::Problem problem = problem_of(error, candidates);
  google::rpc::Status status;
  status.set_code(numbers_of(error.code).grpc_status);
  status.set_message(problem.pointer().empty() ? problem.detail() : problem.pointer() + ": " + problem.detail());

  google::rpc::ErrorInfo info;
  info.set_reason(capitals(problem.code()));
  info.set_domain("geosis");
  status.add_details()->PackFrom(info);
  if (!problem.pointer().empty()) {
    google::rpc::BadRequest bad;
    auto& violation = *bad.add_field_violations();
    violation.set_field(problem.pointer());
    violation.set_description(problem.detail());
    status.add_details()->PackFrom(bad);
  }
  if (may_succeed_later(error.code)) {
    google::rpc::RetryInfo retry;
    retry.mutable_retry_delay()->set_seconds(retry_seconds);
    status.add_details()->PackFrom(retry);
  }
  status.add_details()->PackFrom(problem);
  return {static_cast<grpc::StatusCode>(status.code()), status.message(), status.SerializeAsString()};
}

}  // namespace geosis::server::rpc
