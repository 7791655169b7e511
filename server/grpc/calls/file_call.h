#pragma once

#include <atomic>
#include <memory>
#include <utility>
#include <vector>

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include "server/app/volumes/uploads.h"
#include "server/grpc/calls/call.h"
#include "server/grpc/calls/receiving.h"
#include "server/grpc/messages/wire.h"

namespace geosis::server::rpc {

/// A call that brings a file in a stream of messages and gets one answer. gRPC's threads put what comes into the
/// receiver's inbox; the file has a thread of its own. Messages as they are on the wire: only_field() says why.
///
/// Request   of the stream: options or a chunk.
template <class Request>
class FileCall : public grpc::ServerReadReactor<grpc::ByteBuffer> {
 public:
  FileCall(CallRoom& room, grpc::CallbackServerContext& context, grpc::ByteBuffer& response, const char* method)
      : call_(room, context, method, Access::write),
        context_(context),
        response_(response),
        receiver_(room, [this] { StartRead(&bytes_); }) {}

  /// Owned by gRPC until OnDone, and by the file's thread.
  void start(std::shared_ptr<FileCall> self) {
    self_ = std::move(self);
    if (call_.refusal()) return Finish(call_.failed(*call_.refusal()));
    read();
  }

  void OnReadDone(bool ok) override {
    using Next = typename FileReceiver<Request>::Next;
    call_.client_came();
    if (ok) call_.count_in(bytes_.Length());
    switch (receiver_.take(bytes_, ok)) {
      case Next::read_more:
        return receiver_.has_started() ? StartRead(&bytes_) : read();
      case Next::wait:
        return;
      case Next::start:
        if (!call_.room().uploads.start(call_.peer(), [self = self_] { self->run(); }))
          return Finish(call_.failed(too_busy()));
        if (receiver_.reads_on()) StartRead(&bytes_);
        return;
      case Next::refuse:
        return Finish(call_.failed(receiver_.refusal()));
    }
  }
  void OnCancel() override {
    has_left_ = true;
    receiver_.inbox().break_off({ErrorCode::cancelled, "the caller left"});
  }
  void OnDone() override {
    call_.over();
    self_.reset();
  }

 protected:
  /// Takes the file and gives the answer, on the file's own thread. candidates: what a refusal may name.
  virtual Result<void> receive(const Services& services, std::vector<GridCandidate>& candidates) = 0;

  FileReceiver<Request>& receiver() { return receiver_; }
  const std::atomic<bool>& has_left() const { return has_left_; }
  /// To be asked before anything is kept: a stream that is cancelled ends like one that is complete, and only after
  /// that it is known. errors: cancelled.
  Result<void> confirm() const {
    if (has_left_ || context_.IsCancelled()) return Error{ErrorCode::cancelled, "the caller left"};
    return {};
  }
  void set_answer(const google::protobuf::Message& message) {
    response_ = serialized(message);
    call_.count_out(response_.Length());
  }

 private:
  void read() {
    call_.expect_client(call_.room().patience);
    StartRead(&bytes_);
  }

  void run() {
    grpc::Status status = call_.failed({ErrorCode::internal, "an unexpected failure; nothing was stored"});
    try {
      status = receive();
    } catch (...) {
    }
    if (has_left_) call_.set_abandoned();
    receiver_.inbox().break_off({ErrorCode::cancelled, "the call is over"});  // nothing more is received
    Finish(std::move(status));
  }

  grpc::Status receive() {
    const Services services = call_.services();
    const auto memory = memory_to_import(services);
    if (!memory) return call_.failed(memory.error());
    std::vector<GridCandidate> candidates;
    const auto received = receive(services, candidates);
    return received ? call_.ok() : call_.failed(received.error(), candidates);
  }

  Call call_;
  grpc::CallbackServerContext& context_;
  grpc::ByteBuffer& response_;
  grpc::ByteBuffer bytes_;
  FileReceiver<Request> receiver_;
  std::atomic<bool> has_left_{false};
  std::shared_ptr<FileCall> self_;
};

}  // namespace geosis::server::rpc
