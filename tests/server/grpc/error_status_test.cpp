#include "server/grpc/messages/error_status.h"

#include <algorithm>
#include <cctype>
#include <string>

#include <geosis/v1/volume.pb.h>
#include <google_rpc.pb.h>
#include <gtest/gtest.h>

#include "server/app/errors.h"

namespace geosis::server::rpc {
namespace {

google::rpc::Status details_of(const grpc::Status& status) {
  google::rpc::Status details;
  EXPECT_TRUE(details.ParseFromString(status.error_details()));
  return details;
}

/// The detail of this type, if there is one.
template <class Detail>
std::optional<Detail> find(const google::rpc::Status& status) {
  for (const auto& any : status.details()) {
    Detail detail;
    if (any.UnpackTo(&detail)) return detail;
  }
  return std::nullopt;
}

TEST(StatusOf, EveryCodeHasItsNumberAndName) {
  for (int i = 0; i <= static_cast<int>(ErrorCode::internal); ++i) {
    const auto code = static_cast<ErrorCode>(i);
    const grpc::Status status = status_of({code, "why"}, 7);
    EXPECT_EQ(static_cast<int>(status.error_code()), numbers_of(code).grpc_status) << name_of(code);
    EXPECT_EQ(status.error_message(), "why");
    const auto details = details_of(status);
    EXPECT_EQ(details.code(), numbers_of(code).grpc_status);
    EXPECT_EQ(find<v1::Problem>(details)->code(), name_of(code));
    std::string reason = name_of(code);
    std::transform(reason.begin(), reason.end(), reason.begin(), [](unsigned char c) { return std::toupper(c); });
    EXPECT_EQ(find<google::rpc::ErrorInfo>(details)->reason(), reason);
    EXPECT_EQ(find<google::rpc::ErrorInfo>(details)->domain(), "geosis");
    const auto retry = find<google::rpc::RetryInfo>(details);
    const bool may_retry = code == ErrorCode::unavailable || code == ErrorCode::quota_exceeded;
    EXPECT_EQ(retry.has_value(), may_retry) << name_of(code);
    EXPECT_EQ(retry ? retry->retry_delay().seconds() : 7, 7);
    EXPECT_FALSE(find<google::rpc::BadRequest>(details));
  }
}

TEST(StatusOf, AFieldAtFaultIsNamed) {
  const auto status = status_of({ErrorCode::invalid_argument, "request /range/0: 3; expected less"}, 1);
  EXPECT_EQ(status.error_message(), "/range/0: 3; expected less");
  const auto bad = find<google::rpc::BadRequest>(details_of(status));
  ASSERT_TRUE(bad);
  EXPECT_EQ(bad->field_violations(0).field(), "/range/0");
  EXPECT_EQ(bad->field_violations(0).description(), "3; expected less");
  EXPECT_EQ(find<v1::Problem>(details_of(status))->pointer(), "/range/0");
}

TEST(StatusOf, FitsIntoMetadataWhateverTheMessageHolds) {
  const std::vector<GridCandidate> many(1000, GridCandidate{189, 193, {1000, 1000, 1000}, 5});
  const auto status = status_of({ErrorCode::malformed_input, std::string(100'000, '\xff')}, 1, many);
  EXPECT_LT(status.error_details().size() + status.error_message().size(), 6000u);
  EXPECT_GT(find<v1::Problem>(details_of(status))->candidates_size(), 10);
}

}  // namespace
}  // namespace geosis::server::rpc
