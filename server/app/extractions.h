#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "server/app/byte_stream.h"
#include "server/app/volumes.h"
#include "server/documents/json_text.h"
#include "server/jobs/job_queue.h"
#include "server/store/blob_store.h"

namespace geosis::server {

enum class LevelFormat { drc, ply, obj };

/// Bytes of one level or part, with what a transport says about them.
struct LevelFile {
  std::string sha256;  ///< hexadecimal; the strong validator
  std::uint64_t bytes = 0;
  std::unique_ptr<ByteStream> stream;
  std::string transform;  ///< 16 numbers, comma separated, for drc
};

/// Use cases around extractions, without any transport.
///
/// Stored under <tenant>/extractions/<eid>/: request.json (before anything is acknowledged), parts/<level>.<part>.drc,
/// levels/<level>.<format> (whole files, made on first request), manifest.json (last: done), cancelled.json.
class Extractions {
 public:
  Extractions(BlobStore& store, Volumes& volumes, JobQueue& queue, std::string tenant, int threads);

  struct Created {
    std::string id;
    bool is_done = false;  ///< it was there already
  };
  /// Records the request durably and starts it unless it is done or running. Adds the caller's interest.
  Result<Created> create(const std::string& volume, const Json& request, Priority priority);
  /// Triangles, bytes, memory and seconds from the index alone.
  Result<Json> estimate(const std::string& volume, const Json& request);
  /// Waits until it is final, at most so long.
  void wait(const std::string& id, std::chrono::milliseconds time);
  /// The resource: state, stage, progress, request, levels so far, error, timings, links.
  Result<Json> resource(const std::string& id);
  Result<Json> manifest(const std::string& id);  ///< unavailable-with-state while it is not done: see is_done
  Result<Json> bodies(const std::string& id);
  Result<LevelFile> level(const std::string& id, int level, LevelFormat format);
  Result<LevelFile> part(const std::string& id, int level, int part);

  /// Server-sent events from `after` on.
  Result<std::unique_ptr<ByteStream>> events(const std::string& id, std::uint64_t after);
  /// multipart/mixed: parts coarsest level first, the manifest last. The stream's death before its end withdraws the
  /// caller's interest when `withdraws` is set.
  Result<std::unique_ptr<ByteStream>> stream(const std::string& id, const std::string& boundary, bool withdraws);

  /// Takes one interest away; without any left the job is cancelled, durably.
  Result<void> withdraw(const std::string& id);
  Result<void> purge(const std::string& id);
};

}  // namespace geosis::server
