#pragma once

#include <memory>
#include <string>

#include <grpcpp/security/credentials.h>
#include <grpcpp/security/server_credentials.h>

#include "engine/base/result.h"

namespace geosis::server::rpc {

/// Files in PEM.
struct TlsFiles {
  std::string certificate, key;    ///< of the door; empty = plain HTTP/2
  std::string client_authorities;  ///< clients must show a certificate that one of them signed; empty = nothing
};

/// What a door speaks, and with what it asks itself.
struct DoorCredentials {
  std::shared_ptr<grpc::ServerCredentials> server;
  /// The door knows whom it asks, so the certificate, which is for other names, is not judged. Where clients must show
  /// one, the door makes itself one for the life of the process, and believes it beside the authorities.
  std::shared_ptr<grpc::ChannelCredentials> own_client;
};

/// errors   invalid_argument: a file that cannot be read, authorities that are no certificates. Whether certificate and
///          key belong together shows when the server is built.
Result<DoorCredentials> door_credentials(const TlsFiles& files);

}  // namespace geosis::server::rpc
