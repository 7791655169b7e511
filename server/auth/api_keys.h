#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/result.h"

namespace geosis::server {

/// What a caller may do.
struct Scopes {
  bool read = false;   ///< volumes:read: ask about volumes and for what can be computed from them
  bool write = false;  ///< volumes:write: upload, change and remove
};

/// Who calls.
struct Caller {
  std::string name, tenant;
  Scopes scopes;
};

/// The callers that a file names, one a line: name, hash of the key, tenant, scopes, parted by blanks.
///
///     # name   key                    tenant   scopes
///     ci       sha256:9f86d081...     default  volumes:read,volumes:write
///
/// Keys are 256 random bits, so that a plain hash tells nothing of them; the file holds no key.
class ApiKeys {
 public:
  /// errors   not_found, unavailable: the file cannot be read.  malformed_input: a line that makes no sense (it is
  ///          named by its number; its text is not repeated), a name or hash twice, no line at all.
  static Result<ApiKeys> read(const std::filesystem::path& file);
  static Result<ApiKeys> parse(std::string_view text);

  /// The caller whose key this is. Takes as long for any key that is wrong, however much of it is right.
  const Caller* find(std::string_view key) const;
  /// Of all callers, each once, sorted.
  std::vector<std::string> tenants() const;

 private:
  using Hash = std::array<std::byte, 32>;
  struct Entry {
    Hash hash;
    Caller caller;
  };

  static Result<Entry> parse_line(std::string_view line);

  std::vector<Entry> entries_;
};

/// A new key and the line of the file that lets it in.
struct NewKey {
  std::string key, line;
};

/// errors   invalid_argument: a name or tenant that is not 1 to 64 of a-z 0-9 - _, no scope.  unavailable: no
/// randomness.
Result<NewKey> make_key(const Caller& caller);

/// "volumes:read,volumes:write" and the like; nothing for other words.
std::optional<Scopes> parse_scopes(std::string_view text);

}  // namespace geosis::server
