#include "server/net/pem.h"

#include <cstdint>
#include <utility>

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/x509v3.h>

namespace geosis::server {
namespace {

constexpr long kDay = 24 * 3600;
constexpr long kCentury = 36'500 * kDay;

using Bytes = std::unique_ptr<BIO, decltype(&BIO_free)>;

std::string text_of(BIO* bytes) {
  char* begin = nullptr;
  const long count = BIO_get_mem_data(bytes, &begin);
  return {begin, static_cast<std::size_t>(count)};
}

bool add_address(X509* certificate) {
  const std::unique_ptr<X509_EXTENSION, decltype(&X509_EXTENSION_free)> address(
      X509V3_EXT_conf_nid(nullptr, nullptr, NID_subject_alt_name, "IP:127.0.0.1"), &X509_EXTENSION_free);
  return address && X509_add_ext(certificate, address.get(), -1) == 1;
}

Bytes bytes_of(const std::string& text) {
  return {BIO_new_mem_buf(text.data(), static_cast<int>(text.size())), &BIO_free};
}

/// Signed by the key itself.
bool fill(X509* certificate, EVP_PKEY* key, const std::string& name) {
  std::uint64_t serial = 0;
  X509_NAME* const subject = X509_get_subject_name(certificate);
  return RAND_bytes(reinterpret_cast<unsigned char*>(&serial), sizeof serial) == 1 &&
         ASN1_INTEGER_set_uint64(X509_get_serialNumber(certificate), serial) == 1 &&
         X509_set_version(certificate, X509_VERSION_3) == 1 &&
         X509_gmtime_adj(X509_getm_notBefore(certificate), -kDay) != nullptr &&
         X509_gmtime_adj(X509_getm_notAfter(certificate), kCentury) != nullptr &&
         X509_NAME_add_entry_by_txt(subject, "CN", MBSTRING_UTF8, reinterpret_cast<const unsigned char*>(name.c_str()),
                                    -1, -1, 0) == 1 &&
         X509_set_issuer_name(certificate, subject) == 1 && X509_set_pubkey(certificate, key) == 1 &&
         add_address(certificate) && X509_sign(certificate, key, EVP_sha256()) > 0;
}

}  // namespace

Result<SignedKey> make_signed_key(const std::string& name) {
  const KeyPointer key(EVP_EC_gen("P-256"), &EVP_PKEY_free);
  const CertificatePointer certificate(X509_new(), &X509_free);
  const Bytes key_text(BIO_new(BIO_s_mem()), &BIO_free), certificate_text(BIO_new(BIO_s_mem()), &BIO_free);
  const bool is_made =
      key && certificate && key_text && certificate_text && fill(certificate.get(), key.get(), name) &&
      PEM_write_bio_PKCS8PrivateKey(key_text.get(), key.get(), nullptr, nullptr, 0, nullptr, nullptr) == 1 &&
      PEM_write_bio_X509(certificate_text.get(), certificate.get()) == 1;
  if (!is_made) return Error{ErrorCode::internal, "TLS: no certificate could be made"};
  return SignedKey{text_of(key_text.get()), text_of(certificate_text.get())};
}

std::vector<CertificatePointer> read_certificates(const std::string& pem) {
  const Bytes bytes = bytes_of(pem);
  ERR_clear_error();
  std::vector<CertificatePointer> all;
  for (;;) {
    CertificatePointer next(PEM_read_bio_X509(bytes.get(), nullptr, nullptr, nullptr), &X509_free);
    if (!next) break;
    all.push_back(std::move(next));
  }
  const bool is_whole = ERR_GET_REASON(ERR_peek_last_error()) == PEM_R_NO_START_LINE;
  ERR_clear_error();
  if (!is_whole) all.clear();
  return all;
}

KeyPointer read_key(const std::string& pem) {
  const auto no_password = [](char*, int, int, void*) { return -1; };  // else the terminal is asked for one
  KeyPointer key(PEM_read_bio_PrivateKey(bytes_of(pem).get(), nullptr, no_password, nullptr), &EVP_PKEY_free);
  ERR_clear_error();
  return key;
}

}  // namespace geosis::server
