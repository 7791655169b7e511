#pragma once

#include <memory>
#include <string>

#include "engine/base/result.h"
#include "server/http/channel.h"

namespace geosis::server::http {

/// A certificate with its key, and what connections behind it have in common: TLS 1.2 or 1.3, HTTP/1.1 alone.
class TlsContext {
 public:
  /// certificate, key   files in PEM; the certificate's file holds those that lead to it as well.
  /// errors             invalid_argument: unreadable, or the key is another certificate's.
  static Result<std::unique_ptr<TlsContext>> load(const std::string& certificate, const std::string& key);
  ~TlsContext();

  /// The channel greets its client with the first receive(). The context outlives it.
  std::unique_ptr<Channel> accept(Descriptor socket) const;

 private:
  struct Settings;
  explicit TlsContext(std::unique_ptr<Settings> settings);
  std::unique_ptr<Settings> settings_;
};

}  // namespace geosis::server::http
