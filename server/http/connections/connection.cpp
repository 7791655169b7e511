#include "server/http/connections/connection.h"

#include <array>
#include <span>
#include <string_view>
#include <utility>

#include <sys/epoll.h>

#include "server/http/routing/error_reply.h"

namespace geosis::server::http {
namespace {

constexpr std::size_t kReceiveBytes = 16 * 1024;

}  // namespace

Connection::Connection(std::uint64_t id, std::unique_ptr<Channel> channel, std::string peer, ConnectionOwner& owner)
    : id_(id),
      channel_(std::move(channel)),
      peer_(std::move(peer)),
      owner_(owner),
      deadline_(Clock::now() + owner.limits().head_deadline),
      idle_since_(Clock::now()),
      rate_(owner.limits().bytes_per_second, owner.limits().rate_window) {}

std::uint32_t Connection::interest() const {
  const std::uint32_t departure = is_half_closed_ ? 0U : std::uint32_t{EPOLLRDHUP};
  switch (state_) {
    case State::reading_head:
    case State::reading_body:
    case State::starting_upload:
    case State::lingering:
      return channel_->read_event();
    case State::handling:
    case State::suspended:
    case State::waiting:
      return departure;
    case State::writing:
      return channel_->write_event() | departure;
    case State::uploading:
    case State::finished:
      break;
  }
  return 0;
}

void Connection::on_events(std::uint32_t events) {
  if (events & (EPOLLERR | EPOLLHUP)) return finish();
  if (events & EPOLLRDHUP) {
    is_half_closed_ = true;
    // A small answer is still delivered; nobody is there for what may come later.
    if (suspended_ || (writer_ && writer_->has_stream())) return finish();
  }
  if (!(events & (EPOLLIN | EPOLLOUT))) return;
  if (state_ == State::writing) return write();
  receive();
}

void Connection::on_bell() {
  if (state_ == State::waiting) write();
  if (state_ == State::suspended && suspended_->pending->is_ready()) resume();
}

void Connection::on_tick() {
  const auto now = Clock::now();
  if (state_ == State::writing && !judge_rate()) return drop();
  if (state_ == State::suspended && (now >= suspended_->pending->deadline() || suspended_->pending->is_ready())) {
    return resume();
  }
  if (state_ == State::waiting && now - quiet_since_ >= owner_.limits().quiet_time) {
    quiet_since_ = now;
    if (writer_->say_idle_text()) return write();
  }
  const bool has_deadline = state_ == State::reading_head || state_ == State::reading_body ||
                            state_ == State::starting_upload || state_ == State::lingering;
  if (!has_deadline || now < deadline_) return;
  if (is_idle() || state_ == State::lingering) return finish();
  refuse({408, "the request did not arrive in time"});
}

void Connection::on_drain() {
  if (state_ == State::suspended && suspended_->pending->can_end_early()) return resume();
  if (state_ != State::reading_head) return;
  receive();  // what is already here is still answered
  if (state_ == State::reading_head && in_.empty()) finish();
}

void Connection::receive() {
  std::array<char, kReceiveBytes> piece;
  const Channel::Moved received = channel_->receive(piece);
  if (received.outcome == Channel::Moved::Outcome::blocked) return;
  if (received.outcome == Channel::Moved::Outcome::ended && state_ == State::starting_upload) {
    return start_upload();  // which says that it is cut short
  }
  if (received.outcome != Channel::Moved::Outcome::some) return finish();
  if (state_ == State::lingering) return;
  if (in_.empty() && state_ == State::reading_head) deadline_ = Clock::now() + owner_.limits().head_deadline;
  in_.append(piece.data(), received.count);
  advance();
}

void Connection::advance() {
  is_advancing_ = true;
  for (bool is_next = true; is_next && state_ == State::reading_head;) {
    const std::size_t before = in_.size();
    read_head();
    is_next = in_.size() < before && !in_.empty();  // answered at once: the next one's turn
  }
  is_advancing_ = false;
  if (state_ == State::reading_body) read_body();
  if (state_ == State::starting_upload) read_upload_start();
}

void Connection::read_head() {
  const std::size_t length = head_length(in_, searched_);
  searched_ = in_.size();
  if (length == std::string_view::npos) {
    if (in_.size() <= owner_.limits().head.bytes) return;
    const bool has_line = in_.find('\n') != std::string::npos;
    return refuse(
        has_line ? Refusal{431, "the request's head is too long"} : Refusal{414, "the request's target is too long"},
        seen_request_line(in_));
  }
  const std::string_view text = std::string_view(in_).substr(0, length);
  auto head = parse_head(text, owner_.limits().head);
  const auto* refusal = std::get_if<Refusal>(&head);
  const RequestLine line = refusal ? seen_request_line(text) : RequestLine();
  in_.erase(0, length);
  searched_ = 0;
  if (refusal) return refuse(*refusal, line);
  begin_request(std::get<Head>(std::move(head)));
}

void Connection::begin_request(Head head) {
  closes_ = !head.keeps_alive || owner_.is_draining();
  resolved_ = owner_.dispatcher().resolve(head);
  if (!head.has_body() && head.method != "POST") return begin_without_body();
  if (owner_.dispatcher().is_upload(*resolved_)) return begin_upload(std::move(head));
  begin_small_body(head);
}

void Connection::begin_without_body() {
  if (auto reply = owner_.dispatcher().run_quickly(*resolved_)) {
    const ReplyForm form{.is_head = resolved_->request.method == "HEAD", .closes = closes_};
    resolved_.reset();
    return answer(std::make_unique<ReplyWriter>(*std::move(reply), form));
  }
  expect(owner_.handle(*this, *std::exchange(resolved_, std::nullopt)));
}

void Connection::begin_small_body(const Head& head) {
  if (head.has_body() && !std::holds_alternative<const Handler*>(resolved_->target)) {
    // Nobody will take the body: the refusal comes before it.
    closes_ = true;
    return expect(owner_.handle(*this, *std::exchange(resolved_, std::nullopt)));
  }
  if (head.content_length.value_or(0) > owner_.limits().small_body_bytes) {
    return refuse({413, "the body is too long for this path"});
  }
  body_.emplace(head, owner_.limits().small_body_bytes);
  state_ = State::reading_body;
  deadline_ = Clock::now() + owner_.limits().head_deadline;
  if (head.expects_continue) invite();
}

void Connection::invite() {
  constexpr std::string_view kInvitation = "HTTP/1.1 100 Continue\r\n\r\n";
  if (in_.empty()) channel_->send(std::span(&kInvitation, 1));  // who does not get it sends its body after a while
}

void Connection::begin_upload(Head head) {
  if (head.content_length.value_or(0) > owner_.limits().upload_bytes) {
    return refuse({413, "the body is larger than this server takes"});
  }
  if (!owner_.takes_uploads_of(peer_)) return refuse({503, "too many uploads are running"});
  closes_ = true;
  state_ = State::starting_upload;
  deadline_ = Clock::now() + owner_.limits().head_deadline;
  if (head.expects_continue) invite();
  upload_ = UploadStart{std::move(head), *std::exchange(resolved_, std::nullopt)};
}

void Connection::read_upload_start() {
  switch (upload_->look_at(in_)) {
    case UploadStart::State::too_little:
      return;
    case UploadStart::State::enough:
      return start_upload();
    case UploadStart::State::broken:
      return refuse({400, "the body's chunked coding is broken"});
  }
}

void Connection::start_upload() {
  state_ = State::uploading;
  UploadStart start = *std::exchange(upload_, std::nullopt);
  if (owner_.upload(*this, std::move(start.head), std::move(start.resolved), std::exchange(in_, {}))) return;
  refuse({503, "too many uploads are running"});
}

void Connection::read_body() {
  switch (body_->feed(in_)) {
    case BodyCollector::State::incomplete:
      return;
    case BodyCollector::State::too_big:
      return refuse({413, "the body is too long for this path"});
    case BodyCollector::State::broken:
      return refuse({400, "the body's chunked coding is broken"});
    case BodyCollector::State::complete:
      break;
  }
  resolved_->request.body = body_->take();
  body_.reset();
  expect(owner_.handle(*this, *std::exchange(resolved_, std::nullopt)));
}

void Connection::expect(bool is_taken) {
  state_ = State::handling;
  if (!is_taken) refuse({503, "too many requests are waiting"});
}

void Connection::refuse(const Refusal& refusal, const RequestLine& line) {
  closes_ = true;
  Request seen;
  seen.method = line.method;
  seen.path = line.path;
  const Request* request = resolved_ ? &resolved_->request : upload_ ? &upload_->resolved.request : &seen;
  Reply reply = owner_.dispatcher().refuse(*request, refusal);
  resolved_.reset();
  upload_.reset();
  body_.reset();
  answer(std::make_unique<ReplyWriter>(std::move(reply), ReplyForm{.is_head = false, .closes = true}));
}

}  // namespace geosis::server::http
