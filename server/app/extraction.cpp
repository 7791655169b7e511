#include "server/app/extraction.h"

#include <utility>

#include "server/app/problem.h"

namespace geosis::server {
namespace {

Json timings_document(const std::optional<ExtractionTimings>& timings) {
  if (!timings) return nullptr;
  return {{"load", timings->load},
          {"fill", timings->fill},
          {"extract", timings->extract},
          {"simplify", timings->simplify},
          {"encode", timings->encode},
          {"certify", timings->certify},
          {"first_level", timings->first_level},
          {"total", timings->total}};
}

}  // namespace

Extraction::Snapshot Extraction::snapshot() const {
  const std::lock_guard lock(mutex_);
  Snapshot now;
  now.levels = levels_;
  now.manifest = manifest_;
  now.timings = timings_;
  if (job_) {
    JobStatus status = job_->status();
    now.state = status.state;
    now.stage = std::move(status.stage);
    now.progress = status.progress;
    now.error = std::move(status.error);
  }
  if (cancelled_) now.state = JobState::cancelled;
  if (manifest_) {  // the manifest is the truth, a moment before the job says so
    now.state = JobState::done;
    now.progress = 1;
  }
  return now;
}

Job::Subscription Extraction::subscribe(std::function<void()> bell) {
  const std::lock_guard lock(mutex_);
  return job_ && !manifest_ ? job_->subscribe(std::move(bell)) : Job::Subscription{};
}

void Extraction::wait_for(std::chrono::milliseconds time) const {
  std::shared_ptr<Job> job;
  {
    const std::lock_guard lock(mutex_);
    job = job_;
  }
  if (job) job->wait_for(time);
}

bool Extraction::has_ended() const {
  const std::lock_guard lock(mutex_);
  return manifest_ || cancelled_ || (job_ && is_final(job_->status().state));
}

void Extraction::set_job(std::shared_ptr<Job> job) {
  const std::lock_guard lock(mutex_);
  job_ = std::move(job);
}

void Extraction::add_level(Json entry) {
  std::shared_ptr<Job> job;
  {
    const std::lock_guard lock(mutex_);
    levels_.push_back(std::move(entry));
    job = job_;
  }
  if (job) job->ring();
}

void Extraction::complete(Json manifest, std::optional<ExtractionTimings> timings) {
  std::shared_ptr<Job> job;
  {
    const std::lock_guard lock(mutex_);
    levels_.assign(manifest.at("levels").rbegin(), manifest.at("levels").rend());
    manifest_ = std::move(manifest);
    timings_ = std::move(timings);
    job = job_;
  }
  if (job) job->ring();
}

void Extraction::set_cancelled() {
  const std::lock_guard lock(mutex_);
  cancelled_ = true;
}

bool Extraction::add_interest() {
  const std::lock_guard lock(mutex_);
  if (ending_) return false;
  ++interest_;
  return true;
}

bool Extraction::withdraw_interest() {
  const std::lock_guard lock(mutex_);
  if (interest_ > 0) --interest_;
  if (interest_ > 0 || manifest_ || !job_ || is_final(job_->status().state)) return false;
  return ending_ = true;
}

void Extraction::cancel() {
  std::shared_ptr<Job> job;
  {
    const std::lock_guard lock(mutex_);
    job = job_;
  }
  if (job) job->request_cancel();
}

bool Extraction::is_ending() const {
  const std::lock_guard lock(mutex_);
  return (cancelled_ || ending_ || (job_ && job_->cancelled())) && !manifest_;
}

Json resource_document(const Extraction& extraction) {
  const auto& identity = extraction.identity();
  const Extraction::Snapshot now = extraction.snapshot();
  const std::string self = "/v1/extractions/" + identity.id;
  return {{"id", identity.id},
          {"volume", identity.volume},
          {"state", name_of(now.state)},
          {"stage", now.stage.empty() ? Json(nullptr) : Json(now.stage)},
          {"progress", now.progress},
          {"request", identity.request},
          {"levels", now.levels},
          {"error", now.error ? problem_document(*now.error) : Json(nullptr)},
          {"timings", timings_document(now.timings)},
          {"created_at", identity.created_at},
          {"links",
           {{"self", self},
            {"events", self + "/events"},
            {"stream", self + "/stream"},
            {"manifest", self + "/manifest"},
            {"bodies", self + "/bodies"},
            {"volume", "/v1/volumes/" + identity.volume}}}};
}

}  // namespace geosis::server
