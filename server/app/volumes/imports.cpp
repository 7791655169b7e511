#include "server/app/volumes/imports.h"

#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <utility>
#include <vector>

#include "engine/base/digest.h"
#include "server/app/problem.h"
#include "server/app/volumes/volume_blobs.h"
#include "server/documents/volume_document.h"

namespace geosis::server {
namespace {

constexpr std::chrono::seconds kBetweenRecords{1};

Error no_such_import(const std::string& id) {
  return {ErrorCode::not_found, "volume " + id + ": there is no such volume"};
}

/// No other import ever has the same: what is imported may still be refused, so the id cannot follow from it.
std::string new_import_id(const BlobStore& store) {
  static std::atomic<std::uint64_t> serial{0};
  Sha256 digest;
  digest.update("geosis import 1\n" + store.process_name() + "\n" + std::to_string(serial++) + "\n" + timestamp());
  return std::move(digest).hex();
}

/// Brings the progress of an import to whoever asks any process for it, but not all the time.
class RecordedProgress final : public Progress {
 public:
  RecordedProgress(Job& job, std::function<void(double)> record) : job_(job), record_(std::move(record)) {}
  void report(const char* stage, double fraction) override {
    job_.report(stage, fraction);
    const std::unique_lock lock(mutex_, std::try_to_lock);
    const auto now = std::chrono::steady_clock::now();
    if (!lock || now - recorded_ < kBetweenRecords) return;
    recorded_ = now;
    record_(fraction);
  }
  bool cancelled() const override { return job_.cancelled(); }

 private:
  Job& job_;
  const std::function<void(double)> record_;
  std::mutex mutex_;
  std::chrono::steady_clock::time_point recorded_ = std::chrono::steady_clock::now();
};

Json public_import(const std::string& id, const Json& record) {
  return {{"id", id},
          {"state", record.at("state")},
          {"progress", record.at("progress")},
          {"name", record.at("name")},
          {"created_at", record.at("created_at")},
          {"error", record.at("error")},
          {"links", {{"self", "/v1/volumes/" + id}}}};
}

}  // namespace

Result<Json> Imports::read(const std::string& id) const {
  if (!is_id(id)) return no_such_import(id);
  const auto bytes = store_.get(key(id));
  if (!bytes) return bytes.error().code == ErrorCode::not_found ? no_such_import(id) : bytes.error();
  return parse_json({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
}

Result<void> Imports::write(const std::string& id, const Json& record) const {
  const std::string text = document_text(record);
  return store_.put(key(id), bytes_of(text));
}

Result<Json> Imports::begin(std::shared_ptr<const StagedFile> file, UploadOptions options, std::uint64_t memory_bytes) {
  const std::string id = new_import_id(store_);
  const Json record = {{"state", "importing"},
                       {"progress", 0},
                       {"name", options.name},
                       {"created_at", timestamp()},
                       {"error", nullptr},
                       {"volume", nullptr},
                       {"process", store_.process_name()}};
  if (auto done = write(id, record); !done) return std::move(done).error();
  auto job = queue_.submit(JobDemand{.memory_bytes = memory_bytes, .tenant = volumes_.tenant(), .what = "import " + id},
                           [imports = *this, id, record, file = std::move(file), options](Job& running) {
                             return imports.run(id, record, *file, options, running);
                           });
  if (!job) {
    static_cast<void>(store_.remove(key(id)));
    return std::move(job).error();
  }
  return public_import(id, record);
}

Result<void> Imports::run(const std::string& id, Json record, const StagedFile& file, const UploadOptions& options,
                          Job& job) const {
  RecordedProgress progress(job, [&](double fraction) {
    record["progress"] = fraction;
    static_cast<void>(write(id, record));
  });
  std::vector<GridCandidate> candidates;
  const auto source = open_file(file.path());
  const auto added =
      source ? volumes_.add(**source, options, progress, candidates) : Result<UploadResult>(source.error());
  if (added) {
    record["state"] = "ready";
    record["progress"] = 1;
    record["volume"] = added->document.at("id");
  } else {
    record["state"] = "failed";
    record["error"] = problem_document(added.error());
    if (!candidates.empty()) record["error"]["candidates"] = candidates_document(candidates);
  }
  if (auto done = write(id, record); !done) return done;
  return added ? Result<void>{} : Result<void>(added.error());
}

Result<Json> Imports::document(const std::string& id) const {
  auto record = read(id);
  if (!record) return record;
  if (record->at("state") == "ready") return volumes_.document(record->at("volume").get<std::string>());
  if (record->at("state") == "importing" && !store_.may_be_running(record->at("process").get<std::string>())) {
    (*record)["state"] = "failed";
    (*record)["error"] =
        problem_document({ErrorCode::unavailable, "the server that imported it has ended; upload the file again"});
  }
  return public_import(id, *record);
}

Result<void> Imports::remove(const std::string& id) {
  const auto now = document(id);
  if (!now && now.error().code == ErrorCode::not_found && !read(id)) return now.error();
  if (now && now->at("state") == "importing") {
    return Error{ErrorCode::already_exists,
                 "volume " + id + ": it is importing; it can be removed when that has ended"};
  }
  return store_.remove(key(id));
}

}  // namespace geosis::server
