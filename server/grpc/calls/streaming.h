#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include <grpcpp/support/server_callback.h>

#include "server/grpc/calls/call.h"
#include "server/grpc/calls/strand.h"
#include "server/grpc/messages/message_sources.h"
#include "server/grpc/messages/wire.h"

namespace geosis::server::rpc {

/// The writing half of a call: one message is on its way at a time, and the next is made when it has been taken, so a
/// slow reader holds one message and no thread.
///
/// Reactor   the gRPC reactor that writes Messages.
template <class Reactor, class Message>
class StreamingCall : public Reactor, public Strand {
 public:
  StreamingCall(CallRoom& room, grpc::CallbackServerContext& context, const char* method, Access access)
      : Strand(room.pool), call_(room, context, method, access) {}

  /// Owned by gRPC until OnDone.
  void start(std::shared_ptr<StreamingCall> self) {
    self_ = std::move(self);
    if (call_.refusal())
      finish(call_.failed(*call_.refusal()));
    else if (!begin())
      finish(call_.failed(too_busy()));
  }

  void OnWriteDone(bool ok) override {
    call_.client_came();
    bool is_running_low = false;
    {
      const std::lock_guard lock(writing_);
      is_writing_ = false;
      ++first_;
      if (!ok) has_broken_ = true;
      if (first_ < made_ && !has_broken_) write_first();
      is_running_low = made_ - first_ <= kMost / 2;
    }
    if (is_running_low || !ok) poke();
  }
  void OnCancel() override {
    has_broken_ = true;
    on_left();
    poke();
  }
  void OnDone() override {
    call_.over();
    self_.reset();  // may be the end of this object
  }

 protected:
  using Source = MessageSource<Message>;

  /// Called once, on the strand. Null: it comes by set_source(). errors: the call's end.
  virtual Result<std::unique_ptr<Source>> open_source() = 0;
  /// The client left. From gRPC's threads; quick.
  virtual void on_left() {}

  Call& call() { return call_; }
  /// What to write, or how the call ends. From any thread, once.
  void set_source(std::unique_ptr<Source> source) {
    arriving_ = std::move(source);
    has_arrived_ = true;
    poke();
  }
  void set_end(grpc::Status status) {
    end_ = std::move(status);
    has_arrived_ = true;
    poke();
  }

 private:
  static constexpr std::size_t kMost = 4;  ///< messages that are made and not taken

  void step() final {
    if (is_finished_) return;
    try {
      advance();
    } catch (...) {
      finish(call_.failed({ErrorCode::internal, "an unexpected failure"}));
    }
  }

  void advance() {
    if (has_broken_) return give_up();
    if (!has_opened_) {
      has_opened_ = true;
      auto opened = open_source();
      if (!opened) return finish(call_.failed(opened.error()));
      watch(*std::move(opened));
    }
    if (has_arrived_.exchange(false)) {
      if (end_) return finish(*std::move(end_));
      watch(std::move(arriving_));
    }
    while (source_ && make_next()) {
    }
    if (ending_ && is_all_written()) finish(*std::move(ending_));
  }

  void give_up() {
    call_.set_abandoned();
    if (is_writing()) return;  // its end will be told
    if (!source_ && !ending_ && has_opened_ && !has_arrived_)
      return;  // whoever makes the source learns of it, and says the end
    arriving_.reset();
    finish(call_.failed({ErrorCode::cancelled, "the caller left"}));
  }

  void watch(std::unique_ptr<Source> source) {
    source_ = std::move(source);
    if (!source_) return;
    source_->on_ready([watched = std::weak_ptr<Strand>(shared_from_this())] {
      if (const auto strand = watched.lock()) strand->poke();
    });
  }

  /// Makes a message if there is a place for it. False: not now, or never again.
  bool make_next() {
    {
      const std::lock_guard lock(writing_);
      if (made_ - first_ == kMost) return false;
    }
    Message& message = messages_[made_ % kMost];  // nobody else looks at it
    const auto next = source_->next(message);
    if (next && *next == Source::State::nothing_yet) return false;
    if (!next || *next == Source::State::end) {
      ending_ = next ? call_.ok() : call_.failed(next.error());
      source_.reset();
      return false;
    }
    call_.count_out(wire_bytes(message));
    const std::lock_guard lock(writing_);
    ++made_;
    if (!is_writing_ && !has_broken_) write_first();
    return true;
  }

  /// With the lock held, when no write is under way.
  void write_first() {
    is_writing_ = true;
    call_.expect_client(call_.room().reader_patience);
    this->StartWrite(&messages_[first_ % kMost]);
  }

  bool is_writing() {
    const std::lock_guard lock(writing_);
    return is_writing_;
  }
  bool is_all_written() {
    const std::lock_guard lock(writing_);
    return !is_writing_ && first_ == made_;
  }

  void finish(grpc::Status status) {
    is_finished_ = true;
    source_.reset();
    this->Finish(std::move(status));
  }

  Call call_;
  std::atomic<bool> has_broken_{false}, has_arrived_{false};
  std::mutex writing_;  ///< of what follows
  std::array<Message, kMost> messages_;
  std::size_t first_ = 0, made_ = 0;  ///< messages taken by the client, and made, since the beginning
  bool is_writing_ = false;
  // Of the strand:
  bool has_opened_ = false, is_finished_ = false;
  std::unique_ptr<Source> source_, arriving_;
  std::optional<grpc::Status> end_;     ///< instead of a source that was to come
  std::optional<grpc::Status> ending_;  ///< once all is written
  std::shared_ptr<StreamingCall> self_;
};

}  // namespace geosis::server::rpc
