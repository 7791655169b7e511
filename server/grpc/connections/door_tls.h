#pragma once

#include <memory>
#include <string>

#include <grpcpp/security/credentials.h>
#include <grpcpp/security/server_credentials.h>

#include "engine/base/result.h"
#include "server/net/descriptor.h"
#include "server/net/tls_certificates.h"

namespace geosis::server::rpc {

/// Files in memory with the door's certificates, which gRPC looks at every few seconds: only what was tried gets there,
/// whole. Where clients must show a certificate, the door's own for its questions to itself is believed as well.
class MirroredCertificates {
 public:
  /// own   in PEM, or empty. errors: unavailable: no descriptors or memory.
  static Result<std::unique_ptr<MirroredCertificates>> make(TlsCertificates& certificates, std::string own);

  /// Brings them up to date. To be called every now and then, by one thread.
  void renew();

  bool asks_clients() const { return authorities_.is_open(); }
  std::string certificate_path() const { return path_of(certificate_); }
  std::string key_path() const { return path_of(key_); }
  std::string authorities_path() const { return path_of(authorities_); }

 private:
  MirroredCertificates(TlsCertificates& certificates, std::string own)
      : certificates_(certificates), own_(std::move(own)) {}
  static std::string path_of(const Descriptor& file);
  Result<void> mirror(const TlsTexts& texts);

  TlsCertificates& certificates_;
  const std::string own_;
  std::shared_ptr<const TlsTexts> texts_;  ///< what is in the files
  Descriptor certificate_, key_, authorities_;
};

/// What a door speaks, and with what it asks itself.
struct DoorCredentials {
  std::unique_ptr<MirroredCertificates> files;  ///< outlive the server; null = plain HTTP/2
  std::shared_ptr<grpc::ServerCredentials> server;
  /// The door knows whom it asks, so the certificate, which is for other names, is not judged. Where clients must show
  /// one, the door makes itself one for the life of the process, and believes it beside the authorities.
  std::shared_ptr<grpc::ChannelCredentials> own_client;
};

/// certificates   null = plain HTTP/2; they outlive the credentials.
/// errors         internal, unavailable: no randomness, descriptors or memory.
Result<DoorCredentials> door_credentials(TlsCertificates* certificates);

}  // namespace geosis::server::rpc
