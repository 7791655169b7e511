#include "server/http/routing/error_reply.h"

#include <string_view>
#include <utility>

#include "server/app/errors.h"
#include "server/app/problem.h"
#include "server/http/wire/reply_head.h"

namespace geosis::server::http {
namespace {

constexpr const char* kRetryAfterSeconds = "1";  // where no middleware knows better

Json refusal_document(int status, ErrorCode code, const std::string& detail) {
  return {{"type", std::string("urn:geosis:problem:") + name_of(code)},
          {"title", numbers_of(code).title},
          {"status", status},
          {"detail", detail},
          {"code", name_of(code)}};
}

Reply problem_reply(int status, const Json& document) {
  Reply reply;
  reply.status = status;
  reply.headers = {{"Content-Type", "application/problem+json"}, {"Cache-Control", "no-store"}};
  if (status == 503 || status == 429) reply.headers.emplace_back("Retry-After", kRetryAfterSeconds);
  if (status == 401) reply.headers.emplace_back("WWW-Authenticate", "Bearer realm=\"geosis\"");
  reply.body = document_text(document);
  return reply;
}

ErrorCode code_of(int status) {
  switch (status) {
    case 401:
      return ErrorCode::unauthenticated;
    case 403:
      return ErrorCode::permission_denied;
    case 404:
      return ErrorCode::not_found;
    case 408:
      return ErrorCode::deadline_exceeded;
    case 413:
    case 414:
    case 431:
      return ErrorCode::limit_exceeded;
    case 405:
    case 415:
    case 417:
    case 501:
    case 505:
      return ErrorCode::unsupported;
    case 416:
      return ErrorCode::invalid_argument;
    case 429:
      return ErrorCode::quota_exceeded;
    case 500:
      return ErrorCode::internal;
    case 503:
      return ErrorCode::unavailable;
    default:
      return ErrorCode::malformed_input;
  }
}

}  // namespace

Reply error_reply(const Error& error, const Json& more) {
  Json document = problem_document(error);
  document.update(more);
  return problem_reply(numbers_of(error.code).http_status, document);
}

Reply refusal_reply(const Refusal& refusal) {
  const int status = refusal.status;
  return problem_reply(status, refusal_document(status, code_of(status), refusal.detail));
}

}  // namespace geosis::server::http
