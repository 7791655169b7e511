#include "server/http/front.h"

#include <system_error>
#include <thread>
#include <utility>

#include "server/http/front_loop.h"

namespace geosis::server::http {

/// The loop and its thread.
class Front::Running {
 public:
  Running(const FrontOptions& options, Router routes, Listener listener, Poller poller,
          std::shared_ptr<Mailbox> mailbox, std::unique_ptr<TlsContext> tls)
      : loop_(options, std::move(routes), std::move(listener), std::move(poller), std::move(mailbox), std::move(tls)),
        thread_([this] { loop_.run(); }) {}
  ~Running() { stop(); }

  FrontLoop& loop() { return loop_; }
  void stop() {
    loop_.stop();
    if (thread_.joinable()) thread_.join();
  }

 private:
  FrontLoop loop_;
  std::thread thread_;
};

Result<std::unique_ptr<Front>> Front::start(FrontOptions options, Router routes) {
  std::unique_ptr<TlsContext> tls;
  if (options.certificates != nullptr) {
    auto made = TlsContext::make(*options.certificates);
    if (!made) return std::move(made).error();
    tls = *std::move(made);
  }
  auto listener = Listener::open(options.listen);
  if (!listener) return std::move(listener).error();
  auto poller = Poller::open();
  if (!poller) return std::move(poller).error();
  auto mailbox = Mailbox::open();
  if (!mailbox) return std::move(mailbox).error();
  try {
    auto running = std::make_unique<Running>(options, std::move(routes), *std::move(listener), *std::move(poller),
                                             *std::move(mailbox), std::move(tls));
    return std::unique_ptr<Front>(new Front(std::move(running)));
  } catch (const std::system_error& error) {
    return Error{ErrorCode::unavailable, std::string("cannot start the front's threads: ") + error.what()};
  }
}

Front::Front(std::unique_ptr<Running> running) : running_(std::move(running)) {}
Front::~Front() = default;

std::uint16_t Front::port() const {
  return running_->loop().port();
}
std::size_t Front::connections() const {
  return running_->loop().connections();
}
bool Front::drain(std::chrono::milliseconds grace) {
  return running_->loop().drain(grace);
}
void Front::stop() {
  running_->stop();
}

}  // namespace geosis::server::http
