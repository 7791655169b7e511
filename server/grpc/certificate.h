#pragma once

#include <cstddef>
#include <string>

#include "engine/base/result.h"

namespace geosis::server::rpc {

/// A private key and the certificate that it signed for itself, in PEM.
struct SignedKey {
  std::string key, certificate;
};

/// A new key on P-256, with a certificate for the name and for 127.0.0.1 that stays valid for a century.
///
/// errors   internal: OpenSSL has no randomness or memory.
Result<SignedKey> make_signed_key(const std::string& name);

/// How many certificates the text holds; 0 when one of them is damaged, too.
std::size_t count_certificates(const std::string& pem);

}  // namespace geosis::server::rpc
