#pragma once

#include <chrono>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "engine/base/result.h"
#include "server/app/byte_stream.h"
#include "server/app/derived/fills.h"
#include "server/app/derived/structures.h"
#include "server/app/extractions/compute.h"
#include "server/app/extractions/extraction.h"
#include "server/app/extractions/extraction_blobs.h"
#include "server/app/extractions/extraction_watch.h"
#include "server/app/extractions/run_record.h"
#include "server/app/volumes/volumes.h"
#include "server/jobs/job_queue.h"
#include "server/store/blob_store.h"

namespace geosis::server {

enum class LevelFormat { drc, glb, ply, obj, stl };

/// "drc", "glb", ...: the extension of its files; nullopt for any other word.
std::optional<LevelFormat> level_format_of(std::string_view extension);
std::string extension_of(LevelFormat format);

/// One file of a result, with what a transport says about it.
struct LevelFile {
  std::string sha256;  ///< hexadecimal: the strong validator
  std::uint64_t bytes = 0;
  std::unique_ptr<ByteStream> stream;
  std::string transform;  ///< 16 numbers, for drc
};

/// Its bytes in memory. errors: those of the stream; internal: they are not what the digest says.
Result<std::string> read_whole(LevelFile& file);

/// Who wants to know what happens; both may be empty. Called from any thread; must not throw.
struct ExtractionEvents {
  std::function<void(bool is_hit)> asked = {};  ///< create(): a hit was there already, or under way
  std::function<void(const Extraction::Identity&, const ExtractionTimings&)> computed = {};
};

/// Use cases around extractions, without any transport. Any thread may call any member. The queue must have stopped
/// before this object goes.
///
/// Stored under <tenant>/extractions/<id>/: `request.json` (before anything is acknowledged),
/// `parts/<level>.<part>.drc`, `levels/<level>.<format>` with a description beside it (whole files, made on first
/// request), `bodies.json` (made on first request), `empty.json` (why there are no levels), `run.json` and
/// `levels.json` until it is done (RunRecord: who wants it, who computes it, which levels are ready), and
/// `manifest.json`, written last: an extraction is done when its manifest is there.
/// <tenant>/volumes/<volume>/results/<id> tells what was derived from a volume. docs/store.md tells what follows for
/// several servers on one store.
class Extractions {
 public:
  /// threads   that one extraction may use.
  Extractions(BlobStore& store, Volumes& volumes, JobQueue& queue, std::string tenant, int threads,
              ReconstructFunction reconstruct = geosis::reconstruct, WatchTiming timing = {});

  /// Set before anything is asked.
  void on_events(ExtractionEvents events) { events_ = std::move(events); }

  /// Records the request durably and starts it, unless it is done or running; equal requests are computed once. A
  /// failed or cancelled one starts again. Adds one interest.
  ///
  /// asked_by     id of the call, for the log.
  /// errors   not_found: the volume; invalid_argument, unsupported: the request; unavailable: the queue is full;
  ///          quota_exceeded; limit_exceeded: it needs more memory than there is.
  Result<std::shared_ptr<Extraction>> create(const std::string& volume, const Json& request, Priority priority,
                                             const std::string& asked_by = {});
  /// What create() would lead to, about, from the volume's index alone: estimate_document(). errors: as create().
  Result<Json> estimate(const std::string& volume, const Json& request);
  /// The extraction, from memory or from the store. One that nobody computes any more is computed here; one that
  /// another server computes is followed.
  ///
  /// errors   not_found.  internal: damaged.  unavailable: recorded by another result version and not done.
  Result<std::shared_ptr<Extraction>> find(const std::string& id);
  /// One shot: the file is imported, reconstructed and forgotten. Parts live as long as the extraction object.
  Result<std::shared_ptr<Extraction>> create_transient(const ByteSource& file, const UploadOptions& upload,
                                                       const Json& request, Progress& progress,
                                                       std::vector<GridCandidate>& candidates);

  /// Takes one interest away; without any left the work stops, durably.
  Result<void> withdraw(const std::string& id);
  /// Removes a stored result.
  Result<void> purge(const std::string& id);
  /// Removes all that was derived from a volume: results, and its filled samples and grid.
  Result<void> purge_results_of(const std::string& volume);
  /// Removes the results that were computed on a grid of a volume.
  Result<void> purge_results_on(const std::string& volume, const std::string& grid);
  /// Removes what is left of results and fills whose volume or request is gone.
  Result<void> collect_garbage();

  /// Whether the store has its manifest just now: what was read of it before is still true. Quick.
  bool has_result(const std::string& id) const;
  /// False when level() would have to make the file first.
  bool is_level_made(const std::string& id, int level, LevelFormat format);
  /// Begins to make it; equal calls share one job. errors: not_found; already_exists: it is not done; unavailable.
  Result<std::shared_ptr<Job>> begin_level(const std::string& id, int level, LevelFormat format);
  /// Level k, whole, in one file; made while the caller waits if it is not there. errors: as begin_level().
  Result<LevelFile> level(const std::string& id, int level, LevelFormat format);
  /// One encoded part; may be read as soon as its level is ready.
  Result<LevelFile> part(const std::string& id, int level, int part);
  /// False when bodies() would have to describe them first.
  bool are_bodies_made(const std::string& id);
  /// Begins to describe them, as begin_level() does.
  Result<std::shared_ptr<Job>> begin_bodies(const std::string& id);
  /// The document of all bodies, as level() gives it.
  Result<LevelFile> bodies(const std::string& id);

 private:
  BlobKey key(const std::string& id, const std::string& name) const {
    return tenant_ + "/extractions/" + id + "/" + name;
  }
  BlobKey result_key(const std::string& volume, const std::string& id) const {
    return tenant_ + "/volumes/" + volume + "/results/" + id;
  }
  Result<Json> read_document(const std::string& id, const char* name) const;
  Result<void> write_document(const BlobKey& key, const Json& document);
  PartReader part_reader(const std::string& id) const;

  /// An id's place in the table. The mutex serialises whoever starts or loads it, so that it happens once.
  struct Entry {
    std::mutex mutex;
    std::shared_ptr<Extraction> extraction;
  };
  std::shared_ptr<Entry> entry_of(const std::string& id);
  void drop_outdated(Entry& entry) const;
  Result<std::shared_ptr<Extraction>> load(Entry& entry, const std::string& id);
  Result<bool> load_for_create(Entry& entry, const std::string& id);
  /// Adds an interest to one that is computed already. False: nobody computes it.
  Result<bool> join(Entry& entry);
  Result<std::shared_ptr<Extraction>> record_and_start(Entry& entry, Extraction::Identity identity, bool is_recorded,
                                                       Priority priority);
  Result<void> record_request(const Extraction::Identity& identity);
  Result<bool> record_interest(const std::string& id, const std::string& owner);
  /// recorded   the job goes on once this says true, and gives up when it says false.
  Result<void> submit(const std::shared_ptr<Extraction>& extraction, const std::string& owner, Priority priority,
                      std::shared_future<bool> recorded);
  /// A request that makes sense for its volume, and the volume.
  struct Wanted {
    ReconstructOptions options;
    std::shared_ptr<const StoredVolume> volume;
  };
  Result<Wanted> check(const std::string& volume, const Json& request);
  JobDemand demand_of(const Extraction::Identity& identity, Priority priority);
  JobDemand demand_of(const BrickedVolume& samples, const ReconstructOptions& options, Priority priority) const;
  void discard_result(const std::string& id) const;
  Result<void> remove_blobs(const std::string& id);
  Result<void> collect_garbage_of(const std::string& id);
  Result<void> remove_leftovers(const std::string& id);
  Result<void> run(const std::shared_ptr<Extraction>& extraction, const std::string& owner, Job& job);
  Result<void> compute(Extraction& extraction, const std::string& owner, Job& job);

  /// Everything that the request of an extraction needs, held.
  struct Opened {
    ReconstructOptions options;
    std::shared_ptr<const StoredVolume> volume;
    std::optional<DipReport> dips{};                       ///< where the grid is chosen by them
    std::shared_ptr<const StructuralGrid> grid{};          ///< null where the request's grid is no structural one
    std::shared_ptr<const NodeGrid> nodes{};               ///< null where it names none
    std::shared_ptr<const FilledStoredVolume> filled{};    ///< null when nothing is filled
    std::shared_ptr<const StoredVolume> attribute_volume;  ///< null when the request names none

    VolumeSummary summary{};  ///< of the volume as the nodes place it

    ExtractionInput input() const;
  };
  Result<Opened> open(const Extraction::Identity& identity, Progress& progress, ExtractionTimings& timings);
  Result<std::shared_ptr<const StoredVolume>> open_attribute_volume(const ReconstructOptions& options,
                                                                    const VolumeSummary& volume);
  /// Whether a request makes sense on the grid that it names.
  Result<void> check_grid(const ReconstructOptions& options, const VolumeSummary& volume) const;
  /// Dips and grid that the request needs.
  Result<void> open_grid(Opened& opened, Progress& progress);
  Result<std::shared_ptr<const FilledStoredVolume>> fill(std::shared_ptr<const StoredVolume> volume,
                                                         const ReconstructOptions& options, Progress& progress);
  Result<std::shared_ptr<Extraction>> find_done(const std::string& id);
  Result<Json> manifest_with_level(const std::string& id, int level);
  Result<LevelFile> described_level(const std::string& id, const std::string& name, const Json& description);
  void forget_level(const std::string& id, const std::string& name);
  Result<LevelFile> whole_level(const std::string& id, int level, LevelFormat format);
  Result<void> make_bodies(const Extraction::Identity& identity, Job& running);
  Result<void> make_level_file(const std::string& id, int level, LevelFormat format, const Json& manifest,
                               Job& running);
  Result<std::shared_ptr<Job>> begin(const Extraction::Identity& identity, const std::string& name,
                                     JobQueue::Work work);

  BlobStore& store_;
  Volumes& volumes_;
  JobQueue& queue_;
  const std::string tenant_;
  const int threads_;
  const ReconstructFunction reconstruct_;
  ExtractionEvents events_;
  Fills fills_;
  Structures structures_;
  std::mutex mutex_;
  std::map<std::string, std::shared_ptr<Entry>> entries_;  ///< recently used, by id
  std::map<BlobKey, std::weak_ptr<Job>> making_;           ///< files that are made on request, by their key
  std::map<BlobKey, FileIdentity> checked_files_;          ///< whole files whose checksums were right
  RunRecords records_;
  ExtractionWatch watch_;  ///< last: its thread uses all above
};

}  // namespace geosis::server
