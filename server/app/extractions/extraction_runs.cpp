#include <atomic>
#include <functional>
#include <map>
#include <utility>

#include "engine/pipeline/grid_stage.h"
#include "server/app/extractions/extractions.h"
#include "server/documents/grid_report.h"
#include "server/documents/ids.h"
#include "server/documents/node_grid_document.h"
#include "server/documents/request.h"
#include "server/documents/request_check.h"

// What computes extractions: those that the store keeps, and those of one call.

namespace geosis::server {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The parts of a transient extraction, kept in memory.
class PartShelf {
 public:
  void put(int level, int part, std::span<const std::byte> bytes) {
    const std::lock_guard lock(mutex_);
    parts_[{level, part}].assign(bytes.begin(), bytes.end());
  }
  Result<std::vector<std::byte>> get(int level, int part) const {
    const std::lock_guard lock(mutex_);
    const auto found = parts_.find({level, part});
    if (found == parts_.end()) return Error{ErrorCode::not_found, part_name(level, part) + ": there is no such part"};
    return found->second;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::pair<int, int>, std::vector<std::byte>> parts_;
};

/// Ends an extraction whose work was dropped before it began: its queue has stopped.
class Unstarted {
 public:
  explicit Unstarted(std::function<void()> end) : end_(std::move(end)) {}
  Unstarted(const Unstarted&) = delete;
  Unstarted& operator=(const Unstarted&) = delete;
  ~Unstarted() {
    if (is_queued_ && !has_started_) end_();
  }
  void set_queued() { is_queued_ = true; }
  void set_started() { has_started_ = true; }

 private:
  const std::function<void()> end_;
  std::atomic<bool> is_queued_{false}, has_started_{false};
};

Error stopping() {
  return {ErrorCode::cancelled, "the server is stopping"};
}

Error about_grid(const Error& error) {
  return {error.code, "request /grid: " + error.message};
}

/// Before the request is read, which would offer ids of grids.
Result<void> check_one_shot_grid(const Json& request) {
  const auto grid = request.find("grid");
  if (grid == request.end() || !grid->is_string()) return {};
  const auto& name = grid->get_ref<const std::string&>();
  for (const GridChoice choice : {GridChoice::given, GridChoice::structural, GridChoice::automatic}) {
    if (name == name_of(choice)) return {};
  }
  return Error{
      is_id(name) ? ErrorCode::unsupported : ErrorCode::invalid_argument,
      "request /grid: \"" + name + "\"; expected given, structural or auto: a one-shot call has no stored grids"};
}

}  // namespace

Result<void> Extractions::submit(const std::shared_ptr<Extraction>& extraction, const std::string& owner,
                                 Priority priority, std::shared_future<bool> recorded) {
  const auto unstarted =
      std::make_shared<Unstarted>([this, extraction, owner] { watch_.release(extraction, owner, stopping()); });
  auto job = queue_.submit(demand_of(extraction->identity(), priority), [=, this](Job& running) -> Result<void> {
    unstarted->set_started();
    if (!recorded.get()) return Error{ErrorCode::cancelled, "others compute it, or it could not be recorded"};
    return run(extraction, owner, running);
  });
  if (!job) return std::move(job).error();
  unstarted->set_queued();
  extraction->set_work(*std::move(job));
  return {};
}

Result<void> Extractions::run(const std::shared_ptr<Extraction>& extraction, const std::string& owner, Job& job) {
  auto outcome = compute(*extraction, owner, job);
  watch_.release(extraction, owner, outcome);
  const std::string& id = extraction->identity().id;
  const auto is_recorded = store_.exists(key(id, kRequest));
  if (!outcome && is_recorded && !*is_recorded) static_cast<void>(remove_leftovers(id));  // it was removed meanwhile
  return outcome;
}

Result<void> Extractions::compute(Extraction& extraction, const std::string& owner, Job& job) {
  const auto& identity = extraction.identity();
  ExtractionProgress progress(extraction, job);
  ExtractionTimings timings;
  const auto opened = open(identity, progress, timings);
  if (!opened) return opened.error();
  const PartWriter write_part = [&](int level, int part, std::span<const std::byte> bytes) {
    return store_.put(key(identity.id, part_name(level, part)), bytes);
  };
  const auto computed =
      compute_extraction(extraction, opened->input(), opened->options, reconstruct_, write_part, progress, timings);
  if (!computed) return volumes_.judged(identity.volume, computed.error());
  if (!watch_.holds(extraction, owner)) return Error{ErrorCode::cancelled, "nobody wants it, or others compute it"};
  if (!computed->empty_because.is_null()) {
    if (auto done = write_document(key(identity.id, kEmptyBecause), computed->empty_because); !done) return done;
  }
  if (auto done = write_document(key(identity.id, kManifest), computed->manifest); !done) return done;
  extraction.complete(computed->manifest, timings, computed->empty_because);
  if (events_.computed) events_.computed(identity, timings);
  return {};
}

ExtractionInput Extractions::Opened::input() const {
  return {.volume = summary,
          .samples = *volume->samples,
          .dips = dips ? &*dips : nullptr,
          .grid = grid.get(),
          .filled = filled ? filled->samples.get() : nullptr,
          .attribute_volume = attribute_volume ? attribute_volume->samples.get() : nullptr,
          .nodes = nodes ? &nodes->geometry : nullptr};
}

Result<Extractions::Opened> Extractions::open(const Extraction::Identity& identity, Progress& progress,
                                              ExtractionTimings& timings) {
  const auto start = Clock::now();
  auto options = parse_request(identity.request);
  if (!options) return std::move(options).error();
  options->threads = threads_;
  auto volume = volumes_.open(identity.volume);
  if (!volume) return std::move(volume).error();
  auto other = open_attribute_volume(*options, (*volume)->summary);
  if (!other) return std::move(other).error();
  timings.load = seconds_since(start);
  Opened opened{.options = *std::move(options), .volume = *std::move(volume), .attribute_volume = *std::move(other)};
  opened.summary = opened.volume->summary;
  if (auto grid = open_grid(opened, progress); !grid) return volumes_.judged(identity.volume, grid.error());
  timings.grid = seconds_since(start) - timings.load;
  auto filled = fill(opened.volume, opened.options, progress);
  if (!filled) return volumes_.judged(identity.volume, filled.error());
  opened.filled = *std::move(filled);
  timings.fill = seconds_since(start) - timings.load - timings.grid;
  return opened;
}

Result<void> Extractions::open_grid(Opened& opened, Progress& progress) {
  if (opened.options.grid == GridChoice::given) return {};
  if (opened.options.grid == GridChoice::curvilinear) {
    auto nodes = volumes_.grids().open(opened.volume->summary, *opened.options.grid_id);
    if (!nodes) return about_grid(nodes.error());
    opened.nodes = *std::move(nodes);
    opened.summary = placed_on(opened.volume->summary, opened.nodes->summary);
    return {};
  }
  if (opened.options.grid == GridChoice::automatic) {
    const auto dips = structures_.dips(*opened.volume, progress);
    if (!dips) return dips.error();
    opened.dips = *dips;
    if (!prefers_structure(*dips)) return {};
  }
  auto grid = structures_.grid(*opened.volume, progress);
  if (!grid) return std::move(grid).error();
  opened.grid = *std::move(grid);
  return {};
}

Result<void> Extractions::check_grid(const ReconstructOptions& options, const VolumeSummary& volume) const {
  if (options.grid != GridChoice::curvilinear) return {};
  const auto grid = volumes_.grids().document(volume.id, *options.grid_id);
  if (!grid) return about_grid(grid.error());
  return check_placed_grid(options, *grid);
}

/// The volume that the attribute `value` is of; null when the request names none.
Result<std::shared_ptr<const StoredVolume>> Extractions::open_attribute_volume(const ReconstructOptions& options,
                                                                               const VolumeSummary& volume) {
  if (!options.attribute_volume) return std::shared_ptr<const StoredVolume>();
  auto other = volumes_.open(*options.attribute_volume);
  if (!other) return Error{other.error().code, "request /attribute_volume: " + other.error().message};
  if (auto fits = check_attribute_volume((*other)->summary, volume); !fits) return std::move(fits).error();
  return other;
}

/// Null when nothing is to be filled.
Result<std::shared_ptr<const FilledStoredVolume>> Extractions::fill(std::shared_ptr<const StoredVolume> volume,
                                                                    const ReconstructOptions& options,
                                                                    Progress& progress) {
  if (options.fill.method == FillMethod::none || !has_missing(*volume->samples)) {
    return std::shared_ptr<const FilledStoredVolume>();
  }
  return fills_.fill(std::move(volume), options.fill, progress);
}

Result<std::shared_ptr<Extraction>> Extractions::create_transient(const ByteSource& file, const UploadOptions& upload,
                                                                  const Json& request, Progress& progress,
                                                                  std::vector<GridCandidate>& candidates) {
  if (auto checked = check_one_shot_grid(request); !checked) return std::move(checked).error();
  auto options = parse_request(request);
  if (!options) return std::move(options).error();
  if (options->attribute_volume) {
    return Error{ErrorCode::unsupported, "request /attribute_volume: a one-shot call has no other volume"};
  }
  options->threads = threads_;
  auto imported = import_volume(file, upload.import, std::nullopt, progress, &candidates);
  if (!imported) return std::move(imported).error();
  const auto volume = std::make_shared<const ImportedVolume>(*std::move(imported));
  const auto shelf = std::make_shared<PartShelf>();
  const VolumeSummary summary = summarize(volume->description);
  if (auto checked = check_request(*options, summary); !checked) return std::move(checked).error();
  Json canonical = request_document(*options, summary.shape);
  const std::string id = extraction_id(summary.id, canonical, kResultVersion);
  auto extraction = std::make_shared<Extraction>(
      Extraction::Identity{id, summary.id, timestamp(), std::move(canonical)},
      [shelf](int level, int part) { return shelf->get(level, part); }, false);
  const std::weak_ptr weak(extraction);
  const auto unstarted = std::make_shared<Unstarted>([weak] {
    if (const auto held = weak.lock()) held->fail(stopping());
  });
  auto job = queue_.submit(
      demand_of(*volume->samples, *options, Priority::interactive), [=, this](Job& running) -> Result<void> {
        unstarted->set_started();
        const auto held = weak.lock();
        if (!held) return Error{ErrorCode::cancelled, "nobody waits for it any more"};
        const PartWriter write_part = [&](int level, int part, std::span<const std::byte> bytes) -> Result<void> {
          shelf->put(level, part, bytes);
          return {};
        };
        ExtractionProgress both(*held, running);
        ExtractionTimings timings;
        const auto computed = compute_extraction(*held, {.volume = summary, .samples = *volume->samples}, *options,
                                                 reconstruct_, write_part, both, timings);
        if (!computed) {
          held->fail(computed.error());
          return computed.error();
        }
        held->complete(computed->manifest, timings, computed->empty_because);
        return {};
      });
  if (!job) return std::move(job).error();
  unstarted->set_queued();
  extraction->set_work(*std::move(job));
  return extraction;
}

}  // namespace geosis::server
