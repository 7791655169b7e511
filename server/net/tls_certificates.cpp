#include "server/net/tls_certificates.h"

#include <fstream>
#include <iterator>
#include <utility>

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <sys/stat.h>

#include "server/net/pem.h"

namespace geosis::server {
namespace {

constexpr std::chrono::seconds kInterval{1};

Error unusable(const std::string& path, const std::string& why) {
  return {ErrorCode::invalid_argument, "TLS: " + path + " " + why};
}

Result<std::string> read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file.is_open() || text.empty()) return unusable(path, "cannot be read");
  return text;
}

std::string last_reason() {
  const char* const reason = ERR_reason_error_string(ERR_peek_last_error());
  ERR_clear_error();
  return reason == nullptr ? "" : reason;
}

Result<void> check_own(const TlsFiles& files, const TlsTexts& texts) {
  const auto chain = read_certificates(texts.certificate);
  if (chain.empty()) return unusable(files.certificate, "holds no certificates in PEM");
  const KeyPointer key = read_key(texts.key);
  if (!key) return unusable(files.key, "holds no key in PEM that needs no password");
  ERR_clear_error();
  const std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context(SSL_CTX_new(TLS_server_method()), &SSL_CTX_free);
  if (!context || SSL_CTX_use_certificate(context.get(), chain.front().get()) != 1) {
    return unusable(files.certificate, "cannot be used: " + last_reason());
  }
  if (SSL_CTX_use_PrivateKey(context.get(), key.get()) != 1) {
    return unusable(files.key, "is not the key of " + files.certificate + ": " + last_reason());
  }
  return {};
}

Result<TlsTexts> read_all(const TlsFiles& files) {
  auto certificate = read_file(files.certificate);
  if (!certificate) return std::move(certificate).error();
  auto key = read_file(files.key);
  if (!key) return std::move(key).error();
  TlsTexts texts{*std::move(certificate), *std::move(key), {}};
  if (auto good = check_own(files, texts); !good) return std::move(good).error();
  if (files.client_authorities.empty()) return texts;
  auto authorities = read_file(files.client_authorities);
  if (!authorities) return std::move(authorities).error();
  if (read_certificates(*authorities).empty()) {
    return unusable(files.client_authorities, "holds something else than certificates in PEM");
  }
  texts.client_authorities = *std::move(authorities);
  return texts;
}

}  // namespace

TlsCertificates::Stamp TlsCertificates::stamp_of(const std::string& path) {
  struct stat status {};
  if (path.empty() || ::stat(path.c_str(), &status) != 0) return {};
  return {status.st_dev, status.st_ino, status.st_size, status.st_mtim.tv_sec, status.st_mtim.tv_nsec};
}

TlsCertificates::Stamps TlsCertificates::stamps() const {
  return {stamp_of(files_.certificate), stamp_of(files_.key), stamp_of(files_.client_authorities)};
}

Result<std::unique_ptr<TlsCertificates>> TlsCertificates::read(const TlsFiles& files, Say say) {
  std::unique_ptr<TlsCertificates> made(new TlsCertificates(files, std::move(say)));
  made->read_ = made->stamps();
  auto texts = read_all(files);
  if (!texts) return std::move(texts).error();
  made->texts_ = std::make_shared<const TlsTexts>(*std::move(texts));
  made->looked_ = std::chrono::steady_clock::now();
  return made;
}

std::shared_ptr<const TlsTexts> TlsCertificates::latest() {
  const std::lock_guard lock(mutex_);
  const auto now = std::chrono::steady_clock::now();
  if (now - looked_ < kInterval) return texts_;
  looked_ = now;
  const Stamps found = stamps();  // before they are read: what is written meanwhile is noticed next time
  if (found == read_) return texts_;
  read_ = found;
  auto texts = read_all(files_);
  if (texts) texts_ = std::make_shared<const TlsTexts>(*std::move(texts));
  say_(texts ? std::nullopt : std::optional(std::move(texts).error()));
  return texts_;
}

}  // namespace geosis::server
