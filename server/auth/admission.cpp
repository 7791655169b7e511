#include "server/auth/admission.h"

#include <algorithm>
#include <cctype>
#include <string>

namespace geosis::server {
namespace {

constexpr std::string_view kScheme = "bearer ";

/// The key of "Bearer KEY"; nothing in any other form.
std::optional<std::string_view> key_of(std::string_view authorization) {
  if (authorization.size() <= kScheme.size()) return std::nullopt;
  const auto is_same = [](unsigned char a, unsigned char b) { return a == std::tolower(b); };
  if (!std::equal(kScheme.begin(), kScheme.end(), authorization.begin(), is_same)) return std::nullopt;
  const std::size_t first = authorization.find_first_not_of(" \t", kScheme.size());
  if (first == std::string_view::npos) return std::string_view();
  return authorization.substr(first, authorization.find_last_not_of(" \t") - first + 1);
}

}  // namespace

Result<Caller> admit_caller(const std::optional<ApiKeys>& keys, std::string_view authorization, bool writes) {
  if (!keys) return Caller{.name = "", .tenant = "default", .scopes = {.read = true, .write = true}};
  const auto key = key_of(authorization);
  if (!key) return Error{ErrorCode::unauthenticated, "this needs a key: Authorization: Bearer KEY"};
  const Caller* const caller = keys->find(*key);
  if (caller == nullptr) return Error{ErrorCode::unauthenticated, "nobody knows this key"};
  if (writes ? caller->scopes.write : caller->scopes.read) return *caller;
  return Error{ErrorCode::permission_denied,
               std::string("this needs the scope ") + (writes ? "volumes:write" : "volumes:read")};
}

}  // namespace geosis::server
