#pragma once

#include <memory>
#include <string>
#include <vector>

#include <openssl/evp.h>
#include <openssl/x509.h>

#include "engine/base/result.h"

namespace geosis::server {

// TlsCertificates and keys as text in PEM.

using CertificatePointer = std::unique_ptr<X509, decltype(&X509_free)>;
using KeyPointer = std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)>;

/// All of a text, in its order; none when one of them is damaged, too.
std::vector<CertificatePointer> read_certificates(const std::string& pem);

/// Null when there is none, or it is locked with a password.
KeyPointer read_key(const std::string& pem);

/// A private key and the certificate that it signed for itself, in PEM.
struct SignedKey {
  std::string key, certificate;
};

/// A new key on P-256, with a certificate for the name and for 127.0.0.1 that stays valid for a century.
///
/// errors   internal: OpenSSL has no randomness or memory.
Result<SignedKey> make_signed_key(const std::string& name);

}  // namespace geosis::server
