#include "server/http/connections/tls.h"

#include <algorithm>
#include <array>
#include <climits>
#include <cstring>
#include <utility>

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <sys/epoll.h>

#include "server/net/pem.h"

namespace geosis::server::http {
namespace {

constexpr std::size_t kRecordBytes = 16 * 1024;

using Session = std::unique_ptr<SSL, decltype(&SSL_free)>;

class TlsChannel final : public Channel {
 public:
  TlsChannel(Descriptor socket, Session session) : Channel(std::move(socket)), session_(std::move(session)) {
    is_broken_ = SSL_set_fd(session_.get(), Channel::socket()) != 1;
    SSL_set_accept_state(session_.get());
  }

  Moved receive(std::span<char> into) override {
    ERR_clear_error();
    std::size_t count = 0;
    const int done = is_broken_ ? 0 : SSL_read_ex(session_.get(), into.data(), into.size(), &count);
    return outcome_of(done, count, read_event_, EPOLLIN);
  }

  /// Small pieces leave in one record.
  Moved send(std::span<const std::string_view> pieces) override {
    thread_local std::array<char, kRecordBytes> record;
    std::string_view next;
    for (std::size_t i = 0, gathered = 0; i < pieces.size() && gathered < record.size(); ++i) {
      if (gathered == 0 && pieces[i].size() >= record.size()) {
        next = pieces[i];
        break;
      }
      const std::size_t count = std::min(pieces[i].size(), record.size() - gathered);
      std::memcpy(record.data() + gathered, pieces[i].data(), count);
      gathered += count;
      next = std::string_view(record.data(), gathered);
    }
    if (next.empty()) return {Moved::Outcome::some, 0};
    ERR_clear_error();
    std::size_t count = 0;
    const int done = is_broken_ ? 0 : SSL_write_ex(session_.get(), next.data(), next.size(), &count);
    return outcome_of(done, count, write_event_, EPOLLOUT);
  }

  void end() override {
    ERR_clear_error();
    if (!is_broken_ && SSL_is_init_finished(session_.get())) SSL_shutdown(session_.get());
    Channel::end();
  }

  std::uint32_t read_event() const override { return read_event_; }
  std::uint32_t write_event() const override { return write_event_; }
  void wake_at(std::size_t) override {}  // records are not what the socket counts

 private:
  Moved outcome_of(int done, std::size_t count, std::uint32_t& event, std::uint32_t usual) {
    event = usual;
    if (done == 1) return {Moved::Outcome::some, count};
    if (is_broken_) return {Moved::Outcome::broken, 0};
    switch (SSL_get_error(session_.get(), done)) {
      case SSL_ERROR_WANT_READ:
        event = EPOLLIN;
        return {};
      case SSL_ERROR_WANT_WRITE:
        event = EPOLLOUT;
        return {};
      case SSL_ERROR_ZERO_RETURN:
        return {Moved::Outcome::ended, 0};
      default:
        is_broken_ = true;  // nothing may be asked of the session any more
        return {Moved::Outcome::broken, 0};
    }
  }

  Session session_;
  std::uint32_t read_event_ = EPOLLIN, write_event_ = EPOLLOUT;
  bool is_broken_ = false;
};

int choose_protocol(SSL*, const unsigned char** chosen, unsigned char* length, const unsigned char* offered,
                    unsigned offered_length, void*) {
  static constexpr unsigned char kSpoken[] = "\x08http/1.1";
  unsigned char* found = nullptr;
  if (SSL_select_next_proto(&found, length, kSpoken, sizeof kSpoken - 1, offered, offered_length) !=
      OPENSSL_NPN_NEGOTIATED) {
    return SSL_TLSEXT_ERR_ALERT_FATAL;
  }
  *chosen = found;
  return SSL_TLSEXT_ERR_OK;
}

std::string last_problem() {
  std::array<char, 256> text{};
  ERR_error_string_n(ERR_get_error(), text.data(), text.size());
  return text.data();
}

}  // namespace

struct TlsContext::Settings {
  std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context{SSL_CTX_new(TLS_server_method()), &SSL_CTX_free};
};

TlsContext::TlsContext(TlsCertificates& certificates, std::shared_ptr<const TlsTexts> texts,
                       std::unique_ptr<Settings> settings)
    : certificates_(certificates), texts_(std::move(texts)), settings_(std::move(settings)) {}
TlsContext::~TlsContext() = default;

Result<std::unique_ptr<TlsContext>> TlsContext::make(TlsCertificates& certificates) {
  auto texts = certificates.latest();
  auto settings = settings_of(*texts);
  if (!settings) return std::move(settings).error();
  return std::unique_ptr<TlsContext>(new TlsContext(certificates, std::move(texts), *std::move(settings)));
}

Result<std::unique_ptr<TlsContext::Settings>> TlsContext::settings_of(const TlsTexts& texts) {
  ERR_clear_error();
  auto settings = std::make_unique<Settings>();
  SSL_CTX* const context = settings->context.get();
  if (!context) return Error{ErrorCode::unavailable, "TLS cannot be set up: " + last_problem()};
  SSL_CTX_set_min_proto_version(context, TLS1_2_VERSION);
  // An answer cut short is noticed by its own framing; compression and renegotiation serve attackers only.
  SSL_CTX_set_options(context, SSL_OP_IGNORE_UNEXPECTED_EOF | SSL_OP_NO_COMPRESSION | SSL_OP_NO_RENEGOTIATION |
                                   SSL_OP_CIPHER_SERVER_PREFERENCE);
  SSL_CTX_set_mode(context,
                   SSL_MODE_ENABLE_PARTIAL_WRITE | SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER | SSL_MODE_RELEASE_BUFFERS);
  SSL_CTX_set_alpn_select_cb(context, choose_protocol, nullptr);
  const auto chain = read_certificates(texts.certificate);
  const KeyPointer key = read_key(texts.key);
  bool is_taken = !chain.empty() && SSL_CTX_use_certificate(context, chain.front().get()) == 1 && key &&
                  SSL_CTX_use_PrivateKey(context, key.get()) == 1;
  for (std::size_t n = 1; n < chain.size() && is_taken; ++n) {
    is_taken = SSL_CTX_add1_chain_cert(context, chain[n].get()) == 1;
  }
  if (!is_taken) return Error{ErrorCode::invalid_argument, "TLS: the certificate is not taken: " + last_problem()};
  return settings;
}

void TlsContext::renew() {
  auto latest = certificates_.latest();
  if (latest == texts_) return;
  texts_ = std::move(latest);
  if (auto settings = settings_of(*texts_)) settings_ = *std::move(settings);  // sessions keep the settings they have
}

std::unique_ptr<Channel> TlsContext::accept(Descriptor socket) {
  renew();
  Session session(SSL_new(settings_->context.get()), &SSL_free);
  if (!session) return nullptr;
  return std::make_unique<TlsChannel>(std::move(socket), std::move(session));
}

}  // namespace geosis::server::http
