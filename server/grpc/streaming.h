#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <utility>

#include <grpcpp/support/server_callback.h>

#include "server/grpc/call.h"
#include "server/grpc/message_sources.h"
#include "server/grpc/strand.h"

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
    has_broken_ = has_broken_ || !ok;
    is_written_ = true;
    poke();
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
  void step() final {
    if (is_finished_) return;
    try {
      advance();
    } catch (...) {
      finish(call_.failed({ErrorCode::internal, "an unexpected failure"}));
    }
  }

  void advance() {
    if (is_writing_ && !is_written_) return;
    is_writing_ = false;
    if (has_broken_) {
      call_.set_abandoned();
      if (!source_ && has_opened_ && !has_arrived_) return;  // whoever makes the source learns of it and says the end
      source_.reset();
      arriving_.reset();
      return finish(call_.failed({ErrorCode::cancelled, "the caller left"}));
    }
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
    if (source_) write_next();
  }

  void watch(std::unique_ptr<Source> source) {
    source_ = std::move(source);
    if (!source_) return;
    source_->on_ready([watched = std::weak_ptr<Strand>(shared_from_this())] {
      if (const auto strand = watched.lock()) strand->poke();
    });
  }

  void write_next() {
    const auto next = source_->next(message_);
    if (!next) return finish(call_.failed(next.error()));
    switch (*next) {
      case Source::State::nothing_yet:
        return;
      case Source::State::end:
        return finish(call_.ok());
      case Source::State::message:
        is_writing_ = true;
        is_written_ = false;
        call_.count_out(message_.ByteSizeLong());
        call_.expect_client(call_.room().reader_patience);
        this->StartWrite(&message_);
    }
  }

  void finish(grpc::Status status) {
    is_finished_ = true;
    source_.reset();
    this->Finish(std::move(status));
  }

  Call call_;
  Message message_;
  std::atomic<bool> is_written_{false}, has_broken_{false}, has_arrived_{false};
  // Of the strand:
  bool is_writing_ = false, has_opened_ = false, is_finished_ = false;
  std::unique_ptr<Source> source_, arriving_;
  std::optional<grpc::Status> end_;
  std::shared_ptr<StreamingCall> self_;
};

}  // namespace geosis::server::rpc
