#include "server/http/connections/pending_replies.h"

#include <utility>

#include "server/http/routing/error_reply.h"

namespace geosis::server::http {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::hours kLongestJob{24};

class PendingJob final : public PendingReply {
 public:
  PendingJob(std::shared_ptr<Job> job, WhenAbandoned abandoned, std::function<Reply()> answer)
      : job_(std::move(job)), abandoned_(abandoned), answer_(std::move(answer)) {}
  ~PendingJob() override {
    subscription_ = {};
    if (!is_answered_ && abandoned_ == WhenAbandoned::cancel) job_->request_cancel();
  }

  void on_ready(std::function<void()> bell) override {
    subscription_ = job_->subscribe([bell = std::move(bell), watched = std::weak_ptr(job_)] {
      const auto job = watched.lock();
      if (!job || is_final(job->status().state)) bell();
    });
  }
  bool is_ready() const override { return is_final(job_->status().state); }
  Clock::time_point deadline() const override { return deadline_; }
  Reply finish() override {
    is_answered_ = is_ready();
    if (!is_answered_) return error_reply({ErrorCode::deadline_exceeded, "it is not done after a day"});
    if (auto outcome = job_->outcome(); !outcome) return error_reply(outcome.error());
    return answer_();
  }

 private:
  const std::shared_ptr<Job> job_;
  const WhenAbandoned abandoned_;
  const std::function<Reply()> answer_;
  const Clock::time_point deadline_ = Clock::now() + kLongestJob;
  Job::Subscription subscription_;
  bool is_answered_ = false;
};

class PendingExtraction final : public PendingReply {
 public:
  PendingExtraction(std::shared_ptr<Extraction> extraction, std::chrono::seconds time,
                    std::function<Reply(const Extraction&)> answer)
      : extraction_(std::move(extraction)), deadline_(Clock::now() + time), answer_(std::move(answer)) {}

  void on_ready(std::function<void()> bell) override {
    subscription_ = extraction_->subscribe([bell = std::move(bell), watched = std::weak_ptr(extraction_)] {
      const auto extraction = watched.lock();
      if (!extraction || extraction->has_ended()) bell();
    });
  }
  bool is_ready() const override { return extraction_->has_ended(); }
  Clock::time_point deadline() const override { return deadline_; }
  bool can_end_early() const override { return true; }
  Reply finish() override { return answer_(*extraction_); }

 private:
  const std::shared_ptr<Extraction> extraction_;
  const Clock::time_point deadline_;
  const std::function<Reply(const Extraction&)> answer_;
  Job::Subscription subscription_;
};

}  // namespace

Reply after_job(Result<std::shared_ptr<Job>> job, WhenAbandoned abandoned, std::function<Reply()> answer) {
  if (!job) return error_reply(job.error());
  Reply reply;
  reply.pending = std::make_unique<PendingJob>(*std::move(job), abandoned, std::move(answer));
  return reply;
}

Reply after_extraction(std::shared_ptr<Extraction> extraction, std::chrono::seconds time,
                       std::function<Reply(const Extraction&)> answer) {
  if (extraction->has_ended() || time.count() == 0) return answer(*extraction);
  Reply reply;
  reply.pending = std::make_unique<PendingExtraction>(std::move(extraction), time, std::move(answer));
  return reply;
}

}  // namespace geosis::server::http
