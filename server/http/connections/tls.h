#pragma once

#include <memory>

#include "engine/base/result.h"
#include "server/http/connections/channel.h"
#include "server/net/tls_certificates.h"

namespace geosis::server::http {

/// A certificate with its key, and what connections behind it have in common: TLS 1.2 or 1.3, HTTP/1.1 alone.
class TlsContext {
 public:
  /// errors   invalid_argument: OpenSSL does not take them.
  static Result<std::unique_ptr<TlsContext>> make(TlsCertificates& certificates);
  ~TlsContext();

  /// The channel greets its client with the first receive(), with the latest certificate.
  std::unique_ptr<Channel> accept(Descriptor socket);

 private:
  struct Settings;
  TlsContext(TlsCertificates& certificates, std::shared_ptr<const TlsTexts> texts, std::unique_ptr<Settings> settings);
  static Result<std::unique_ptr<Settings>> settings_of(const TlsTexts& texts);
  void renew();

  TlsCertificates& certificates_;
  std::shared_ptr<const TlsTexts> texts_;  ///< those of the settings, or refused
  std::unique_ptr<Settings> settings_;
};

}  // namespace geosis::server::http
