#include "server/grpc/calls/unary_call.h"

#include <optional>
#include <utility>

namespace geosis::server::rpc {
namespace {

class UnaryCall final : public grpc::ServerUnaryReactor, public Strand {
 public:
  UnaryCall(CallRoom& room, grpc::CallbackServerContext& context, const char* method, Access access,
            UnaryMessages messages, UnaryWork work)
      : Strand(room.pool, work.lane),
        call_(room, context, method, access),
        messages_(messages),
        work_(std::move(work)) {
    call_.count_in(messages_.request.ByteSizeLong());
  }

  /// Owned by gRPC until OnDone.
  void start(std::shared_ptr<UnaryCall> self) {
    self_ = std::move(self);
    if (call_.refusal())
      finish(*call_.refusal());
    else if (!begin())
      finish(too_busy());
  }

  void OnCancel() override {
    is_cancelled_ = true;
    poke();
  }
  void OnDone() override {
    call_.over();
    self_.reset();  // may be the end of this object
  }

 private:
  void step() override {
    if (is_finished_) return;
    try {
      advance();
    } catch (...) {
      finish({ErrorCode::internal, "an unexpected failure; the call was not carried out"});
    }
  }

  void advance() {
    if (is_cancelled_) return give_up();
    if (!has_begun_) {
      has_begun_ = true;
      if (auto begun = begin_job(); !begun) return finish(begun.error());
    }
    if (job_) {
      if (!is_final(job_->status().state)) return;
      if (auto outcome = job_->outcome(); !outcome) return finish(outcome.error());
    }
    auto answered = work_.answer(call_);
    if (!answered) return finish(answered.error());
    is_finished_ = true;
    call_.count_out(messages_.response.ByteSizeLong());
    Finish(call_.ok());
  }

  Result<void> begin_job() {
    if (!work_.begin) return {};
    auto job = work_.begin(call_);
    if (!job) return std::move(job).error();
    job_ = *std::move(job);
    if (!job_) return {};
    subscription_ = job_->subscribe([watched = std::weak_ptr<Strand>(shared_from_this()), job = std::weak_ptr(job_)] {
      const auto held = job.lock();
      if (held && !is_final(held->status().state)) return;
      if (const auto strand = watched.lock()) strand->poke();
    });
    return {};
  }

  void give_up() {
    call_.set_abandoned();
    if (job_ && work_.owns_job) job_->request_cancel();
    finish({ErrorCode::cancelled, "the caller left"});
  }

  void finish(const Error& error) {
    is_finished_ = true;
    Finish(call_.failed(error));
  }

  Call call_;
  const UnaryMessages messages_;
  const UnaryWork work_;
  std::atomic<bool> is_cancelled_{false};
  bool has_begun_ = false, is_finished_ = false;
  std::shared_ptr<Job> job_;
  Job::Subscription subscription_;
  std::shared_ptr<UnaryCall> self_;
};

}  // namespace

grpc::ServerUnaryReactor* start_unary(CallRoom& room, grpc::CallbackServerContext* context, const char* method,
                                      Access access, UnaryMessages messages, UnaryWork work) {
  const auto call = std::make_shared<UnaryCall>(room, *context, method, access, messages, std::move(work));
  call->start(call);
  return call.get();
}

}  // namespace geosis::server::rpc
