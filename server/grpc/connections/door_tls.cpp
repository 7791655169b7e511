#include "server/grpc/connections/door_tls.h"

#include <optional>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <grpcpp/security/tls_certificate_provider.h>
#include <grpcpp/security/tls_certificate_verifier.h>
#include <grpcpp/security/tls_credentials_options.h>
#include <sys/mman.h>
#include <unistd.h>

#include "server/net/pem.h"

namespace geosis::server::rpc {
namespace {

namespace tls = grpc::experimental;

constexpr unsigned kLookSeconds = 5;

/// A file in memory that holds the text; takes the place of the old one in one step, under its number.
bool put(const std::string& text, Descriptor& file) {
  Descriptor made(::memfd_create("certificates", MFD_CLOEXEC));
  if (!made.is_open() || ::write(made.number(), text.data(), text.size()) != static_cast<ssize_t>(text.size()))
    return false;
  if (file.is_open()) return ::dup3(made.number(), file.number(), O_CLOEXEC) >= 0;
  file = std::move(made);
  return true;
}

std::shared_ptr<grpc::ServerCredentials> server_credentials(const MirroredCertificates& files) {
  const bool asks = files.asks_clients();
  tls::TlsServerCredentialsOptions options(std::make_shared<tls::FileWatcherCertificateProvider>(
      files.key_path(), files.certificate_path(), asks ? files.authorities_path() : "", kLookSeconds));
  options.watch_identity_key_cert_pairs();
  options.set_cert_request_type(asks ? GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY
                                     : GRPC_SSL_DONT_REQUEST_CLIENT_CERTIFICATE);
  if (asks) options.watch_root_certs();
  return tls::TlsServerCredentials(options);
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

Result<std::unique_ptr<MirroredCertificates>> MirroredCertificates::make(TlsCertificates& certificates,
                                                                         std::string own) {
  std::unique_ptr<MirroredCertificates> made(new MirroredCertificates(certificates, std::move(own)));
  made->texts_ = certificates.latest();
  if (auto done = made->mirror(*made->texts_); !done) return std::move(done).error();
  return made;
}

void MirroredCertificates::renew() {
  auto latest = certificates_.latest();
  if (latest != texts_ && mirror(*latest)) texts_ = std::move(latest);  // else again next time
}

Result<void> MirroredCertificates::mirror(const TlsTexts& texts) {
  const bool is_put = put(texts.key, key_) && put(texts.certificate, certificate_) &&
                      (texts.client_authorities.empty() || put(texts.client_authorities + "\n" + own_, authorities_));
  if (is_put) return {};
  return Error{ErrorCode::unavailable, "TLS: no descriptors or memory for certificates"};
}

std::string MirroredCertificates::path_of(const Descriptor& file) {
  return "/proc/self/fd/" + std::to_string(file.number());
}

Result<DoorCredentials> door_credentials(TlsCertificates* certificates) {
  if (certificates == nullptr) {
    return DoorCredentials{nullptr, grpc::InsecureServerCredentials(), grpc::InsecureChannelCredentials()};
  }
  std::optional<SignedKey> identity;
  if (!certificates->latest()->client_authorities.empty()) {
    auto made = make_signed_key("geosis asks itself");
    if (!made) return std::move(made).error();
    identity = *std::move(made);
  }
  auto files = MirroredCertificates::make(*certificates, identity ? identity->certificate : "");
  if (!files) return std::move(files).error();
  auto server = server_credentials(**files);
  return DoorCredentials{*std::move(files), std::move(server), own_client(identity ? &*identity : nullptr)};
}

}  // namespace geosis::server::rpc
