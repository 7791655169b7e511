#include "server/http/front_loop.h"

#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "server/http/routing/error_reply.h"
#include "server/http/uploads/upload_body.h"
#include "server/http/wire/reply_head.h"

namespace geosis::server::http {
namespace {

constexpr std::uint64_t kListenerKey = 0, kMailboxKey = 1, kFirstConnection = 2;
constexpr std::chrono::milliseconds kTick{100};
constexpr int kAcceptedAtOnce = 64;  // those who are here already have their turn in between
constexpr int kBacklog = 4096;

std::string full_answer() {
  const Reply reply = refusal_reply({503, "too many connections are open"});
  return reply_head(reply, {.is_head = false, .closes = true}) + reply.body;
}

}  // namespace

FrontLoop::FrontLoop(const FrontOptions& options, Router routes, Listener listener, Poller poller,
                     std::shared_ptr<Mailbox> mailbox, std::unique_ptr<TlsContext> tls)
    : limits_(options.limits),
      held_bodies_(options.limits.held_bytes),
      dispatcher_(std::move(routes), options.cors, options.middleware),
      listener_(std::move(listener)),
      poller_(std::move(poller)),
      mailbox_(std::move(mailbox)),
      handlers_(options.handler_threads, options.queued_requests),
      own_uploads_(options.upload_threads),
      uploads_(options.uploads ? *options.uploads : own_uploads_),
      tls_(std::move(tls)),
      port_(listener_.port()),
      next_id_(kFirstConnection) {}

void FrontLoop::run() {
  poller_.watch(mailbox_->descriptor(), kMailboxKey, EPOLLIN);
  poller_.watch(listener_.descriptor(), kListenerKey, EPOLLIN);
  while (!is_stopping_) {
    for (const epoll_event& event : poller_.wait(kTick)) on_event(event);
    if (Connection::Clock::now() >= next_tick_) tick();
    if (is_draining_) drain_some();
  }
  close_all();
}

bool FrontLoop::drain(std::chrono::milliseconds grace) {
  is_draining_ = true;
  mailbox_->wake();
  std::unique_lock lock(mutex_);
  return drained_.wait_for(lock, grace, [this] { return is_drained_; });
}

void FrontLoop::stop() {
  is_stopping_ = true;
  mailbox_->wake();
}

void FrontLoop::on_event(const epoll_event& event) {
  if (event.data.u64 == kListenerKey) return accept_some(kAcceptedAtOnce);
  if (event.data.u64 == kMailboxKey) return read_letters();
  const auto found = connections_.find(event.data.u64);
  if (found == connections_.end()) return;
  found->second->on_events(event.events);
  settle(*found->second);
}

void FrontLoop::accept_some(int most) {
  for (int count = 0; count < most && listener_.is_open(); ++count) {
    Listener::Accepted accepted = listener_.accept();
    switch (accepted.outcome) {
      case Listener::Accepted::Outcome::connection:
        admit(std::move(accepted));
        break;
      case Listener::Accepted::Outcome::none:
        return;
      case Listener::Accepted::Outcome::exhausted:
        poller_.forget(listener_.descriptor());  // until the next tick
        return;
    }
  }
}

void FrontLoop::admit(Listener::Accepted accepted) {
  if (!has_room_for(accepted.peer)) end_idlest(connections_.size() < limits_.connections ? &accepted.peer : nullptr);
  if (!has_room_for(accepted.peer)) {
    if (tls_) return;  // a greeting would cost more than the refusal is worth
    const std::string full = full_answer();
    const std::string_view text = full;
    Channel(std::move(accepted.socket)).send(std::span(&text, 1));
    return;
  }
  auto channel =
      tls_ ? tls_->accept(std::move(accepted.socket)) : std::make_unique<Channel>(std::move(accepted.socket));
  if (!channel) return;
  ++peers_[accepted.peer];
  const std::uint64_t id = next_id_++;
  ConnectionOwner& owner = *this;
  auto connection = std::make_unique<Connection>(id, std::move(channel), std::move(accepted.peer), owner);
  open_connections_ = connections_.size() + 1;
  settle(*connections_.emplace(id, std::move(connection)).first->second);
}

bool FrontLoop::has_room_for(const std::string& peer) const {
  const auto of_peer = peers_.find(peer);
  return connections_.size() < limits_.connections &&
         (of_peer == peers_.end() ? 0 : of_peer->second) < limits_.connections_per_peer;
}

void FrontLoop::end_idlest(const std::string* peer) {
  Connection* idlest = nullptr;
  for (const auto& [id, connection] : connections_) {
    if (!connection->is_idle() || (peer && connection->peer() != *peer)) continue;
    if (!idlest || connection->idle_since() < idlest->idle_since()) idlest = connection.get();
  }
  if (idlest) remove(*idlest);
}

void FrontLoop::read_letters() {
  for (Letter& letter : mailbox_->take()) {
    if (letter.answer || letter.suspended) uploads_.finished(letter.connection);
    const auto found = connections_.find(letter.connection);
    if (found == connections_.end()) continue;  // its client left; so does the answer
    Connection& connection = *found->second;
    if (letter.answer) {
      connection.answer(std::move(letter.answer));
    } else if (letter.suspended) {
      connection.suspend(std::move(letter.suspended));
    } else {
      connection.on_bell();
    }
    settle(connection);
  }
}

void FrontLoop::tick() {
  next_tick_ = Connection::Clock::now() + kTick;
  if (listener_.is_open()) poller_.watch(listener_.descriptor(), kListenerKey, EPOLLIN);
  for_each([](Connection& connection) { connection.on_tick(); });
}

void FrontLoop::drain_some() {
  if (listener_.is_open()) {
    accept_some(kBacklog);  // who connected before is still served
    poller_.forget(listener_.descriptor());
    listener_.close();
  }
  for_each([](Connection& connection) { connection.on_drain(); });
  if (!connections_.empty()) return;
  const std::lock_guard lock(mutex_);
  is_drained_ = true;
  drained_.notify_all();
}

void FrontLoop::close_all() {
  for (const auto& [id, connection] : connections_)
    if (connection->is_uploading()) connection->channel().interrupt();
  mailbox_->close();
  handlers_.stop();
  uploads_.join_all();
  for_each([this](Connection& connection) { remove(connection); });
  listener_.close();
}

void FrontLoop::settle(Connection& connection) {
  if (connection.is_finished()) return remove(connection);
  poller_.watch(connection.socket(), connection.id(), connection.interest());
}

void FrontLoop::remove(Connection& connection) {
  poller_.forget(connection.socket());
  const auto peer = peers_.find(connection.peer());
  if (--peer->second == 0) peers_.erase(peer);
  connections_.erase(connection.id());
  open_connections_ = connections_.size();
}

template <class Action>
void FrontLoop::for_each(Action action) {
  std::vector<std::uint64_t> ids;
  ids.reserve(connections_.size());
  for (const auto& [id, connection] : connections_) ids.push_back(id);
  for (const std::uint64_t id : ids) {
    action(*connections_.at(id));
    const auto left = connections_.find(id);
    if (left != connections_.end()) settle(*left->second);
  }
}

template <class Run>
Letter FrontLoop::letter_with_answer(std::uint64_t connection, const Request& request, const ReplyForm& form, Run run) {
  Letter letter{connection, nullptr, nullptr};
  try {
    Reply reply = run();
    auto share = held_bodies_.take(reply.body.size());
    if (!share) reply = dispatcher_.refuse(request, {503, "too many answers wait for their readers"});
    if (reply.pending) {
      letter.suspended = std::make_unique<Suspended>(request, form, std::move(reply));
    } else {
      letter.answer =
          std::make_unique<ReplyWriter>(std::move(reply), form, share ? *std::move(share) : BodyBudget::Share());
    }
  } catch (...) {
    letter.answer = std::make_unique<ReplyWriter>(refusal_reply({500, "an unexpected failure"}), form);
  }
  return letter;
}

bool FrontLoop::handle(Connection& connection, Router::Resolved resolved) {
  const ReplyForm form{.is_head = resolved.request.method == "HEAD", .closes = connection.closes()};
  const bool reads =
      resolved.request.method != "POST" && resolved.request.method != "PATCH" && resolved.request.method != "DELETE";
  return handlers_.submit(
      reads ? HandlerPool::Lane::reading : HandlerPool::Lane::writing,
      [this, id = connection.id(), form, resolved = std::move(resolved)] {
        mailbox_->post(letter_with_answer(id, resolved.request, form, [&] { return dispatcher_.run(resolved); }));
      });
}

bool FrontLoop::upload(Connection& connection, Head head, Router::Resolved resolved, std::string already) {
  const auto work = [this, id = connection.id(), &channel = connection.channel(), head = std::move(head),
                     resolved = std::move(resolved), already = std::move(already)] {
    UploadBody body(channel, head, already, limits_);
    const ReplyForm form{.is_head = false, .closes = true};
    const auto run = [&] { return dispatcher_.run_upload(resolved, body); };
    mailbox_->post(letter_with_answer(id, resolved.request, form, run));
  };
  // The thread owns the socket from its first moment on.
  poller_.forget(connection.socket());
  return uploads_.start(connection.id(), connection.peer(), work);
}

void FrontLoop::resume(Connection& connection, std::unique_ptr<Suspended> suspended) {
  handlers_.resume(HandlerPool::Lane::reading,
                   [this, id = connection.id(), kept = std::shared_ptr<Suspended>(std::move(suspended))] {
                     kept->set_resumed();
                     const auto run = [&] { return dispatcher_.resume(kept->request, *kept->pending); };
                     mailbox_->post(letter_with_answer(id, kept->request, kept->form, run));
                   });
}

std::function<void()> FrontLoop::bell_of(const Connection& connection) {
  return [mailbox = mailbox_, id = connection.id()] { mailbox->post({id, nullptr, nullptr}); };
}

}  // namespace geosis::server::http
