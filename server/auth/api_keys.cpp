#include "server/auth/api_keys.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>
#include <utility>

#include <openssl/crypto.h>
#include <openssl/rand.h>

#include "engine/base/digest.h"
#include "engine/base/hexadecimal.h"

namespace geosis::server {
namespace {

constexpr std::string_view kHashPrefix = "sha256:";
constexpr std::string_view kKeyPrefix = "geosis_";
constexpr std::size_t kKeyBytes = 32;
constexpr const char* kRead = "volumes:read";
constexpr const char* kWrite = "volumes:write";

std::array<std::byte, 32> hash_of(std::string_view key) {
  Sha256 hash;
  hash.update(key);
  return std::move(hash).bytes();
}

bool is_name(std::string_view text) {
  return !text.empty() && text.size() <= 64 && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
  });
}

Error bad_line(const char* what) {
  return {ErrorCode::malformed_input, what};
}

}  // namespace

std::optional<Scopes> parse_scopes(std::string_view text) {
  Scopes scopes;
  std::istringstream words{std::string(text)};
  for (std::string word; std::getline(words, word, ',');) {
    if (word == kRead) {
      scopes.read = true;
    } else if (word == kWrite) {
      scopes.write = true;
    } else {
      return std::nullopt;
    }
  }
  if (!scopes.read && !scopes.write) return std::nullopt;
  return scopes;
}

Result<ApiKeys::Entry> ApiKeys::parse_line(std::string_view line) {
  std::istringstream words{std::string(line)};
  const std::vector<std::string> parts{std::istream_iterator<std::string>(words), {}};
  if (parts.size() != 4) return bad_line("expected name, hash, tenant and scopes");
  Entry entry{{}, {parts[0], parts[2], {}}};
  if (!is_name(parts[0])) return bad_line("the name is not 1 to 64 of a-z 0-9 - _");
  if (!is_name(parts[2])) return bad_line("the tenant is not 1 to 64 of a-z 0-9 - _");
  const std::string_view hash = std::string_view(parts[1]).substr(std::min(kHashPrefix.size(), parts[1].size()));
  if (!parts[1].starts_with(kHashPrefix) || !is_lower_hexadecimal(hash) || !read_hexadecimal(hash, entry.hash)) {
    return bad_line("the hash is not sha256: and 64 hexadecimal digits");
  }
  const auto scopes = parse_scopes(parts[3]);
  if (!scopes) return bad_line("the scopes are not volumes:read, volumes:write or both with a comma");
  entry.caller.scopes = *scopes;
  return entry;
}

Result<ApiKeys> ApiKeys::parse(std::string_view text) {
  ApiKeys keys;
  std::istringstream lines{std::string(text)};
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    const auto first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    const std::string where = "line " + std::to_string(number) + ": ";
    auto entry = parse_line(line);
    if (!entry) return Error{entry.error().code, where + entry.error().message};
    const bool is_known = std::any_of(keys.entries_.begin(), keys.entries_.end(), [&](const Entry& other) {
      return other.hash == entry->hash || other.caller.name == entry->caller.name;
    });
    if (is_known) return Error{ErrorCode::malformed_input, where + "a name or hash that another line has"};
    keys.entries_.push_back(*std::move(entry));
  }
  if (keys.entries_.empty()) return Error{ErrorCode::malformed_input, "there is no key in it"};
  return keys;
}

Result<ApiKeys> ApiKeys::read(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) return Error{ErrorCode::not_found, file.string() + ": cannot be opened"};
  std::ostringstream text;
  text << stream.rdbuf();
  if (stream.bad()) return Error{ErrorCode::unavailable, file.string() + ": cannot be read"};
  auto keys = parse(text.str());
  if (!keys) return Error{keys.error().code, file.string() + ": " + keys.error().message};
  return keys;
}

const Caller* ApiKeys::find(std::string_view key) const {
  const Hash hash = hash_of(key);
  const Caller* found = nullptr;
  for (const Entry& entry : entries_) {  // all of them, whichever it is
    if (CRYPTO_memcmp(hash.data(), entry.hash.data(), hash.size()) == 0) found = &entry.caller;
  }
  return found;
}

std::vector<std::string> ApiKeys::tenants() const {
  std::vector<std::string> tenants;
  for (const Entry& entry : entries_) tenants.push_back(entry.caller.tenant);
  std::sort(tenants.begin(), tenants.end());
  tenants.erase(std::unique(tenants.begin(), tenants.end()), tenants.end());
  return tenants;
}

Result<NewKey> make_key(const Caller& caller) {
  if (!is_name(caller.name)) return Error{ErrorCode::invalid_argument, "--name: expected 1 to 64 of a-z 0-9 - _"};
  if (!is_name(caller.tenant)) return Error{ErrorCode::invalid_argument, "--tenant: expected 1 to 64 of a-z 0-9 - _"};
  if (!caller.scopes.read && !caller.scopes.write) return Error{ErrorCode::invalid_argument, "--scopes: none"};
  std::array<std::byte, kKeyBytes> random{};
  if (RAND_bytes(reinterpret_cast<unsigned char*>(random.data()), static_cast<int>(random.size())) != 1) {
    return Error{ErrorCode::unavailable, "the system gives no random numbers"};
  }
  NewKey made;
  made.key = std::string(kKeyPrefix) + hexadecimal(random);
  const std::string scopes = std::string(caller.scopes.read ? kRead : "") +
                             (caller.scopes.read && caller.scopes.write ? "," : "") +
                             (caller.scopes.write ? kWrite : "");
  made.line = caller.name + " " + std::string(kHashPrefix) + hexadecimal(hash_of(made.key)) + " " + caller.tenant +
              " " + scopes;
  return made;
}

}  // namespace geosis::server
