#include "server/service/probe_tls.h"

#include <algorithm>
#include <climits>
#include <utility>

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>

namespace geosis::server {
namespace {

using Context = std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)>;

Result<void> set_trust(SSL_CTX* context, const ProbeTrust& trust) {
  if (trust.any_certificate) return {};
  SSL_CTX_set_verify(context, SSL_VERIFY_PEER, nullptr);
  const bool is_read = trust.authorities.empty() ? SSL_CTX_set_default_verify_paths(context) == 1
                                                 : SSL_CTX_load_verify_file(context, trust.authorities.c_str()) == 1;
  if (is_read) return {};
  return Error{ErrorCode::invalid_argument, trust.authorities + ": holds no certificates in PEM that can be read"};
}

/// Whom the certificate must be for; a name is told to the server as well, which may have several.
bool expect_host(SSL* session, const std::string& host) {
  if (X509_VERIFY_PARAM_set1_ip_asc(SSL_get0_param(session), host.c_str()) == 1) return true;
  return SSL_set1_host(session, host.c_str()) == 1 && SSL_set_tlsext_host_name(session, host.c_str()) == 1;
}

Error failed_handshake(SSL* session) {
  const long verdict = SSL_get_verify_result(session);
  if (verdict != X509_V_OK) {
    return {ErrorCode::unavailable, std::string("its certificate is not to be believed: ") +
                                        X509_verify_cert_error_string(verdict) +
                                        " (--ca PEM says whom to believe, --any-certificate not to ask)"};
  }
  const char* const why = ERR_reason_error_string(ERR_peek_last_error());
  return {ErrorCode::unavailable, std::string("no TLS handshake: ") + (why ? why : "the other side says nothing")};
}

}  // namespace

struct ProbeTls::Session {
  Context context{SSL_CTX_new(TLS_client_method()), &SSL_CTX_free};
  std::unique_ptr<SSL, decltype(&SSL_free)> tls{nullptr, &SSL_free};
};

ProbeTls::ProbeTls(std::unique_ptr<Session> session) : session_(std::move(session)) {}
ProbeTls::ProbeTls(ProbeTls&&) noexcept = default;
ProbeTls::~ProbeTls() = default;

Result<ProbeTls> ProbeTls::begin(int socket, const std::string& host, const ProbeTrust& trust) {
  ERR_clear_error();
  auto session = std::make_unique<Session>();
  if (!session->context) return Error{ErrorCode::unavailable, "TLS cannot be set up"};
  if (auto trusted = set_trust(session->context.get(), trust); !trusted) return std::move(trusted).error();
  SSL_CTX_set_min_proto_version(session->context.get(), TLS1_2_VERSION);
  session->tls.reset(SSL_new(session->context.get()));  // after its settings, which it copies
  SSL* const tls = session->tls.get();
  if (!tls || !expect_host(tls, host) || SSL_set_fd(tls, socket) != 1) {
    return Error{ErrorCode::unavailable, "TLS cannot be set up for " + host};
  }
  if (SSL_connect(tls) != 1) return failed_handshake(tls);
  return ProbeTls(std::move(session));
}

bool ProbeTls::send(const std::string& text) {
  return SSL_write(session_->tls.get(), text.data(), static_cast<int>(text.size())) == static_cast<int>(text.size());
}

long ProbeTls::receive(char* into, std::size_t capacity) {
  const int count = SSL_read(session_->tls.get(), into, static_cast<int>(std::min<std::size_t>(capacity, INT_MAX)));
  if (count > 0) return count;
  return SSL_get_error(session_->tls.get(), count) == SSL_ERROR_ZERO_RETURN ? 0 : -1;
}

}  // namespace geosis::server
