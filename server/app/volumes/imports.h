#pragma once

#include <memory>
#include <string>

#include "engine/base/result.h"
#include "server/app/volumes/volumes.h"
#include "server/documents/json_text.h"
#include "server/jobs/job_queue.h"
#include "server/store/blob_store.h"

namespace geosis::server {

/// Imports that go on after their upload was answered. What they know is in the store, <tenant>/imports/<id>.json: any
/// process tells how an import goes. The file is not: an import whose process ends has failed.
///
/// A value: the objects that it refers to outlive the queue's jobs.
class Imports {
 public:
  Imports(BlobStore& store, Volumes& volumes, JobQueue& queue) : store_(store), volumes_(volumes), queue_(queue) {}

  /// Begins the import of a received file.
  ///
  /// memory_bytes   that the job reserves while it runs.
  /// returns        its document. errors: unavailable: the queue is full; those of the store.
  Result<Json> begin(std::shared_ptr<const StagedFile> file, UploadOptions options, std::uint64_t memory_bytes);

  /// {"id", "state": importing | failed, "progress", "name", "created_at", "error", "links"}, and the volume's own
  /// document once it is ready. errors: not_found.
  Result<Json> document(const std::string& id) const;
  /// Forgets an import that has ended; the volume stays. errors: not_found; already_exists: it goes on.
  Result<void> remove(const std::string& id);

 private:
  BlobKey key(const std::string& id) const { return volumes_.tenant() + "/imports/" + id + ".json"; }
  Result<Json> read(const std::string& id) const;
  Result<void> write(const std::string& id, const Json& record) const;
  Result<void> run(const std::string& id, Json record, const StagedFile& file, const UploadOptions& options,
                   Job& job) const;

  BlobStore& store_;
  Volumes& volumes_;
  JobQueue& queue_;
};

}  // namespace geosis::server
