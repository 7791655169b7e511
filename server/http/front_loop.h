#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <unordered_map>

#include "server/http/connections/body_budget.h"
#include "server/http/connections/connection.h"
#include "server/http/connections/mailbox.h"
#include "server/http/connections/poller.h"
#include "server/http/connections/tls.h"
#include "server/http/front.h"
#include "server/http/uploads/upload_threads.h"
#include "server/jobs/handler_pool.h"
#include "server/net/listener.h"

namespace geosis::server::http {

/// The front's one loop: it wakes connections when their sockets, streams, handlers or deadlines are ready.
class FrontLoop final : private ConnectionOwner {
 public:
  FrontLoop(const FrontOptions& options, Router routes, Listener listener, Poller poller,
            std::shared_ptr<Mailbox> mailbox, std::unique_ptr<TlsContext> tls);

  /// Serves until stop(); the calling thread becomes the loop's.
  void run();

  // From any thread:
  std::uint16_t port() const { return port_; }
  std::size_t connections() const { return open_connections_; }
  bool drain(std::chrono::milliseconds grace);
  void stop();

 private:
  const Limits& limits() const override { return limits_; }
  const Dispatcher& dispatcher() const override { return dispatcher_; }
  bool is_draining() const override { return is_draining_; }
  bool handle(Connection& connection, Router::Resolved resolved) override;
  bool takes_uploads_of(const std::string& peer) const override { return uploads_.has_room(peer); }
  bool upload(Connection& connection, Head head, Router::Resolved resolved, std::string already) override;
  void resume(Connection& connection, std::unique_ptr<Suspended> suspended) override;
  std::function<void()> bell_of(const Connection& connection) override;

  void on_event(const epoll_event& event);
  void accept_some(int most);
  void admit(Listener::Accepted accepted);
  bool has_room_for(const std::string& peer) const;
  /// Ends the connection that has been idle longest, of this peer or of any.
  void end_idlest(const std::string* peer);
  void read_letters();
  void tick();
  void drain_some();
  void close_all();
  /// Follows a connection's new wishes; it may be gone afterwards.
  void settle(Connection& connection);
  void remove(Connection& connection);
  /// Calls `action` for each connection, of which any may be removed meanwhile.
  template <class Action>
  void for_each(Action action);

  /// What `run` answers, as a letter to the request's connection; whatever happens there is one.
  template <class Run>
  Letter letter_with_answer(std::uint64_t connection, const Request& request, const ReplyForm& form, Run run);

  Limits limits_;
  BodyBudget held_bodies_;
  Dispatcher dispatcher_;
  Listener listener_;
  Poller poller_;
  std::shared_ptr<Mailbox> mailbox_;
  HandlerPool handlers_;
  Slots own_uploads_;
  UploadThreads uploads_;
  std::unique_ptr<TlsContext> tls_;  ///< null = plain
  std::uint16_t port_;
  std::uint64_t next_id_;
  std::unordered_map<std::uint64_t, std::unique_ptr<Connection>> connections_;
  std::atomic<std::size_t> open_connections_ = 0;
  std::map<std::string, std::size_t> peers_;  ///< connections by address
  Connection::Clock::time_point next_tick_;

  std::atomic<bool> is_draining_ = false, is_stopping_ = false;
  std::mutex mutex_;
  std::condition_variable drained_;
  bool is_drained_ = false;
};

}  // namespace geosis::server::http
