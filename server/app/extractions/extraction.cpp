#include "server/app/extractions/extraction.h"

#include <utility>

#include "server/app/problem.h"

namespace geosis::server {
namespace {

Json timings_document(const std::optional<ExtractionTimings>& timings) {
  if (!timings) return nullptr;
  return {{"load", timings->load},         {"grid", timings->grid},
          {"fill", timings->fill},         {"extract", timings->extract},
          {"simplify", timings->simplify}, {"encode", timings->encode},
          {"certify", timings->certify},   {"first_level", timings->first_level},
          {"total", timings->total}};
}

std::string path_of(const Extraction& extraction) {
  return "/v1/extractions/" + extraction.identity().id;
}

}  // namespace

Extraction::Snapshot Extraction::snapshot() const {
  Snapshot now;
  std::string manifest;
  {
    const std::lock_guard lock(mutex_);
    now.levels = levels_;
    now.timings = timings_;
    now.empty_because = empty_because_;
    manifest = manifest_;
  }
  JobStatus status = face_->status();
  now.state = status.state;
  now.stage = std::move(status.stage);
  now.progress = status.progress;
  now.error = std::move(status.error);
  if (!manifest.empty()) {  // the manifest is the truth, a moment before the face says so
    now.manifest = Json::parse(manifest);
    now.levels.assign(now.manifest->at("levels").rbegin(), now.manifest->at("levels").rend());
    now.state = JobState::done;
    now.progress = 1;
    now.error.reset();
  }
  return now;
}

bool Extraction::is_done() const {
  const std::lock_guard lock(mutex_);
  return !manifest_.empty();
}

Job::Subscription Extraction::subscribe(std::function<void()> bell) {
  return has_ended() ? Job::Subscription{} : face_->subscribe(std::move(bell));
}

void Extraction::abandon() {
  if (!is_stored_)
    cancel();
  else if (!is_cancelled())  // of one that is ending no interest is left to take
    ++abandoned_;
}

void Extraction::set_work(std::shared_ptr<Job> work) {
  const std::lock_guard lock(mutex_);
  work_ = std::move(work);
}

void Extraction::stop_work() {
  std::shared_ptr<Job> work;
  {
    const std::lock_guard lock(mutex_);
    work = work_;
  }
  if (work) work->request_cancel();
}

bool Extraction::wait_for_work(std::chrono::milliseconds time) const {
  std::shared_ptr<Job> work;
  {
    const std::lock_guard lock(mutex_);
    work = work_;
  }
  return !work || work->wait_for(time);
}

void Extraction::report(const char* stage, double fraction) {
  face_->set_running();
  face_->report(stage, fraction);
}

void Extraction::add_level(Json entry) {
  {
    const std::lock_guard lock(mutex_);
    if (!manifest_.empty()) return;
    for (const Json& known : levels_) {
      if (known.at("level") == entry.at("level")) return;
    }
    levels_.push_back(std::move(entry));
  }
  face_->ring();
}

void Extraction::complete(const Json& manifest, std::optional<ExtractionTimings> timings, Json empty_because) {
  {
    const std::lock_guard lock(mutex_);
    levels_ = {};
    manifest_ = manifest.dump(-1, ' ', false, Json::error_handler_t::replace);
    timings_ = std::move(timings);
    empty_because_ = std::move(empty_because);
  }
  face_->finish({});
}

void Extraction::cancel() {
  stop_work();
  face_->request_cancel();
}

Json shown_level(const Extraction& extraction, Json entry) {
  const auto show = [&](Json& url) {
    if (url.is_string()) url = path_of(extraction) + "/" + url.get<std::string>();
  };
  show(entry.at("url"));
  for (Json& part : entry.at("parts")) show(part.at("url"));
  return entry;
}

Json resource_document(const Extraction& extraction) {
  const auto& identity = extraction.identity();
  Extraction::Snapshot now = extraction.snapshot();
  const std::string self = path_of(extraction);
  for (Json& entry : now.levels) entry = shown_level(extraction, std::move(entry));
  return {{"id", identity.id},
          {"volume", identity.volume},
          {"state", name_of(now.state)},
          {"stage", now.stage.empty() ? Json(nullptr) : Json(now.stage)},
          {"progress", now.progress},
          {"request", identity.request},
          {"levels", now.levels},
          {"empty", now.manifest && now.levels.empty()},
          {"empty_because", std::move(now.empty_because)},
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
