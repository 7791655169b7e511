#pragma once

#include <memory>
#include <vector>

#include "engine/base/result.h"
#include "server/http/routing/exchange.h"

namespace geosis::server::http {

/// A digest that a request states of its body.
struct StatedDigest {
  enum class Algorithm { sha256, sha512 } algorithm = Algorithm::sha256;
  std::vector<unsigned char> bytes;
};

/// Those of the Content-Digest header (RFC 9530); of algorithms other than sha-256 and sha-512 it allows to know
/// nothing.
///
/// errors   invalid_argument: not base64 of the algorithm's length between colons.
Result<std::vector<StatedDigest>> stated_digests(const Request& request);

/// A body that is hashed as it is read, by every algorithm that its request states a digest of.
class DigestedBody final : public CheckedBody {
 public:
  DigestedBody(BodyReader& body, std::vector<StatedDigest> stated);
  ~DigestedBody() override;

  Result<std::size_t> read(std::span<std::byte> into) override;
  Result<void> check() override;

 private:
  class Hash;
  BodyReader& body_;
  std::vector<std::unique_ptr<Hash>> hashes_;
};

}  // namespace geosis::server::http
