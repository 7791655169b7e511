#include "server/grpc/door_tls.h"

#include <fstream>
#include <iterator>
#include <utility>

#include <grpcpp/security/tls_certificate_provider.h>
#include <grpcpp/security/tls_certificate_verifier.h>
#include <grpcpp/security/tls_credentials_options.h>

#include "server/grpc/certificate.h"

namespace geosis::server::rpc {
namespace {

namespace tls = grpc::experimental;

Result<std::string> read_pem(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file.is_open() || text.empty()) return Error{ErrorCode::invalid_argument, path + ": cannot be read"};
  return text;
}

Result<std::string> read_authorities(const std::string& path) {
  auto text = read_pem(path);
  if (text && count_certificates(*text) == 0) {
    return Error{ErrorCode::invalid_argument, "TLS: " + path + " holds something else than certificates in PEM"};
  }
  return text;
}

std::shared_ptr<grpc::ChannelCredentials> own_client(const SignedKey* identity) {
  tls::TlsChannelCredentialsOptions options;
  options.set_verify_server_certs(false);
  options.set_check_call_host(false);
  options.set_certificate_verifier(std::make_shared<tls::NoOpCertificateVerifier>());
  if (identity) {
    options.set_certificate_provider(std::make_shared<tls::StaticDataCertificateProvider>(
        std::vector<tls::IdentityKeyCertPair>{{identity->key, identity->certificate}}));
    options.watch_identity_key_cert_pairs();
  }
  return tls::TlsCredentials(options);
}

}  // namespace

Result<DoorCredentials> door_credentials(const TlsFiles& files) {
  if (files.certificate.empty()) {
    return DoorCredentials{grpc::InsecureServerCredentials(), grpc::InsecureChannelCredentials()};
  }
  auto certificate = read_pem(files.certificate);
  if (!certificate) return std::move(certificate).error();
  auto key = read_pem(files.key);
  if (!key) return std::move(key).error();
  grpc::SslServerCredentialsOptions options;
  options.pem_key_cert_pairs.push_back({*std::move(key), *std::move(certificate)});
  if (files.client_authorities.empty())
    return DoorCredentials{grpc::SslServerCredentials(options), own_client(nullptr)};

  auto authorities = read_authorities(files.client_authorities);
  if (!authorities) return std::move(authorities).error();
  const auto identity = make_signed_key("geosis asks itself");
  if (!identity) return identity.error();
  options.pem_root_certs = *authorities + "\n" + identity->certificate;
  options.client_certificate_request = GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY;
  return DoorCredentials{grpc::SslServerCredentials(options), own_client(&*identity)};
}

}  // namespace geosis::server::rpc
